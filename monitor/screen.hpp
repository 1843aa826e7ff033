#pragma once

#include "core/base/expected.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace atrium::monitor {

/// Standard output: on a terminal a screen of its own that is drawn anew in place, elsewhere one
/// report below the other. The terminal is as it was once this is gone.
class Screen {
public:
    /// `in_place`: where it is a terminal.
    explicit Screen(bool in_place);
    ~Screen();
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    bool is_in_place() const { return in_place_; }
    bool has_colour() const { return has_colour_; }
    std::size_t width() const;   // columns to be used; without a terminal no limit
    std::size_t height() const;  // lines; 0: without limit

    /// Fails where standard output cannot be written.
    Expected<void> show(const std::vector<std::string>& lines);
    /// Leaves the screen of its own, if there is one, and prints below what was there before.
    Expected<void> leave(const std::vector<std::string>& lines);

private:
    void restore();
    bool in_place_;
    bool has_colour_;
};

}  // namespace atrium::monitor
