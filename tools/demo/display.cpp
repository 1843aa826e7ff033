#include "tools/demo/display.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

namespace atrium::demo {

bool Display::is_terminal() { return isatty(STDOUT_FILENO) != 0; }

void Display::show(const std::vector<std::string>& lines, bool is_last) {
    const auto now = Clock::now();
    if (!in_place_ && !is_last && now < next_) return;
    next_ = now + period_;
    if (in_place_ && num_shown_ > 0) fmt::print("\033[{}F\033[J", num_shown_);
    // a wrapped line would take two rows and misplace the next refresh
    winsize size{};
    const bool known = in_place_ && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
    const std::size_t width = known ? size.ws_col - 1u : std::string::npos;
    for (const std::string& line : lines) fmt::print("{}\n", line.substr(0, width));
    std::fflush(stdout);
    num_shown_ = lines.size();
}

void Display::leave() {
    num_shown_ = 0;
    next_ = {};
}

}  // namespace atrium::demo
