#include "tools/calibrate/sweep/sweep_progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

namespace atrium::calibrate {
namespace {

constexpr auto kTerminalPeriod = std::chrono::milliseconds(200);
constexpr auto kLinePeriod = std::chrono::seconds(5);
constexpr const char* kClearLine = "\r\033[K";

std::size_t columns_of_terminal() {
    constexpr std::size_t kUsual = 80;
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col - 1U
                                                                            : kUsual - 1;
}

}  // namespace

SweepProgress::SweepProgress()
    : is_terminal_(isatty(STDERR_FILENO) != 0),
      due_(Clock::now() + (is_terminal_ ? std::chrono::seconds(0) : kLinePeriod)) {}

SweepProgress::~SweepProgress() {
    if (is_terminal_) fmt::print(stderr, "{}", kClearLine);
}

void SweepProgress::say(const std::string& line) {
    fmt::print(stderr, "{}{}\n", is_terminal_ ? kClearLine : "", line);
}

void SweepProgress::update(Observer& observer) {
    for (const std::string& warning : observer.take_warnings()) say("check: " + warning);
    const auto now = Clock::now();
    if (now < due_) return;
    due_ = now + (is_terminal_ ? Clock::duration(kTerminalPeriod) : Clock::duration(kLinePeriod));
    if (is_terminal_) {
        fmt::print(stderr, "{}{}", kClearLine, observer.progress(columns_of_terminal()));
        std::fflush(stderr);
    } else {
        say(observer.progress(0));
    }
}

std::string progress_line(std::string head,
                          const std::vector<std::string>& parts,
                          std::size_t most_characters) {
    for (const std::string& part : parts) {
        constexpr std::size_t kRest = 5;  // "; ..."
        if (most_characters > 0 && head.size() + part.size() + 2 + kRest > most_characters)
            return head + "; ...";
        head += "; " + part;
    }
    return head;
}

}  // namespace atrium::calibrate
