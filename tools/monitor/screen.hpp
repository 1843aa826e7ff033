#pragma once

#include "core/base/expected.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace atrium::monitor {

/// Standard output. On a terminal, redraws the report in place on the alternate screen; elsewhere
/// prints one report after the other. The destructor restores the terminal.
class Screen {
public:
    /// `in_place`: redraw in place if standard output is a terminal.
    explicit Screen(bool in_place);
    ~Screen();
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    bool is_in_place() const { return in_place_; }
    bool has_colour() const { return has_colour_; }
    std::size_t width() const;   // usable columns; no limit without a terminal
    std::size_t height() const;  // lines; 0: no limit

    /// Shows the lines. Error kUnavailable if standard output cannot be written.
    Expected<void> show(const std::vector<std::string>& lines);
    /// Leaves the alternate screen, if it is in use, and prints the lines on the normal one.
    Expected<void> leave(const std::vector<std::string>& lines);

private:
    void restore();
    bool in_place_;
    bool has_colour_;
};

}  // namespace atrium::monitor
