#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace atrium::calibrate {

/// A line that is written over on a terminal, and not at all elsewhere.
class Progress {
public:
    void show(const std::string& text) {
        if (!is_terminal_) return;
        fmt::print(stderr, "\r\033[K{} ...", text);
        std::fflush(stderr);
    }
    ~Progress() {
        if (is_terminal_) fmt::print(stderr, "\r\033[K");
    }

private:
    bool is_terminal_ = isatty(STDERR_FILENO) != 0;
};

}  // namespace atrium::calibrate
