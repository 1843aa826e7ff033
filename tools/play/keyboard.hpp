#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace atrium::play {

/// Standard input: single keys from a terminal, else whole lines. Restores the terminal at the end,
/// also after a second Ctrl-C.
class Keyboard {
public:
    Keyboard();
    ~Keyboard();
    Keyboard(const Keyboard&) = delete;
    Keyboard& operator=(const Keyboard&) = delete;

    bool has_keys() const { return has_keys_; }
    /// False once the input has ended.
    bool is_open() const { return is_open_; }
    /// Waits at most `timeout` and returns what came: keys (an arrow is one), or lines.
    std::vector<std::string> read(std::chrono::milliseconds timeout);

private:
    std::vector<std::string> split_keys();
    std::vector<std::string> split_lines();

    bool has_keys_ = false;
    bool is_open_ = true;
    std::string pending_;
};

}  // namespace atrium::play
