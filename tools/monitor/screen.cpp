#include "tools/monitor/screen.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace atrium::monitor {
namespace {

constexpr std::size_t kNoLimit = 100'000;

Expected<void> put(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() &&
        std::fflush(stdout) == 0) {
        return {};
    }
    return make_error(ErrorKind::kUnavailable,
                      std::string("cannot write to standard output: ") + std::strerror(errno));
}

constexpr char kLeaveInPlace[] = "\033[0m\033[?25h\033[?1049l";

// Restores the terminal at an exit without destructors, after a second Ctrl-C.
std::atomic<bool> has_own_screen{false};
void leave_in_place_at_quick_exit() {
    if (!has_own_screen) return;
    [[maybe_unused]] const auto n =
        ::write(STDOUT_FILENO, kLeaveInPlace, sizeof(kLeaveInPlace) - 1);
}

winsize window_size() {
    winsize size{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return {};
    return size;
}

// Follows https://no-color.org: any value of NO_COLOR except an empty one disables colours.
bool may_have_colour() {
    const char* forbidden = std::getenv("NO_COLOR");
    const char* terminal = std::getenv("TERM");
    return ::isatty(STDOUT_FILENO) != 0 && (forbidden == nullptr || *forbidden == '\0') &&
           terminal != nullptr && std::strcmp(terminal, "dumb") != 0;
}

}  // namespace

Screen::Screen(bool in_place)
    : in_place_(in_place && ::isatty(STDOUT_FILENO) != 0), has_colour_(may_have_colour()) {
    if (!in_place_) return;
    static const int registered = std::at_quick_exit(&leave_in_place_at_quick_exit);
    static_cast<void>(registered);  // if it cannot be registered, only that restore is missing
    has_own_screen = true;
    static_cast<void>(put("\033[?1049h\033[?25l"));  // alternate screen, no cursor
}

Screen::~Screen() { restore(); }

void Screen::restore() {
    if (!in_place_) return;
    static_cast<void>(put(kLeaveInPlace));
    has_own_screen = false;
    in_place_ = false;
}

std::size_t Screen::width() const {
    // leaves out the last column: erasing after it would erase its own character
    const winsize size = window_size();
    return size.ws_col > 1 ? size.ws_col - 1u : kNoLimit;
}

std::size_t Screen::height() const { return in_place_ ? window_size().ws_row : 0; }

Expected<void> Screen::show(const std::vector<std::string>& lines) {
    std::string text = in_place_ ? "\033[H" : "";
    for (std::size_t i = 0; i < lines.size(); ++i) {
        text += lines[i];
        if (in_place_) text += "\033[K";
        // a line end in the last row would scroll
        if (!in_place_ || i + 1 < lines.size()) text += '\n';
    }
    if (in_place_) text += "\033[J";
    return put(text);
}

Expected<void> Screen::leave(const std::vector<std::string>& lines) {
    if (!in_place_) return {};
    restore();
    return show(lines);
}

}  // namespace atrium::monitor
