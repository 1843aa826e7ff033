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

void SweepProgress::update(SweepTally& tally) {
    for (const std::string& warning : tally.take_warnings()) say("check: " + warning);
    const auto now = Clock::now();
    if (now < due_) return;
    due_ = now + (is_terminal_ ? Clock::duration(kTerminalPeriod) : Clock::duration(kLinePeriod));
    if (is_terminal_) {
        fmt::print(stderr, "{}{}", kClearLine, tally.progress(columns_of_terminal()));
        std::fflush(stderr);
    } else {
        say(tally.progress());
    }
}

}  // namespace atrium::calibrate
