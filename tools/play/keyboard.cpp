#include "tools/play/keyboard.hpp"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <thread>

namespace atrium::play {
namespace {

constexpr std::size_t kMaxLineBytes = 64U << 10U;

termios saved_terminal;
std::atomic<bool> is_terminal_changed{false};

void restore_terminal() {
    if (is_terminal_changed.exchange(false)) ::tcsetattr(STDIN_FILENO, TCSANOW, &saved_terminal);
}

}  // namespace

Keyboard::Keyboard() {
    // A job in the background must not touch the terminal: it would be stopped.
    if (::isatty(STDIN_FILENO) == 0 || ::tcgetpgrp(STDIN_FILENO) != ::getpgrp()) {
        is_open_ = ::isatty(STDIN_FILENO) == 0;
        return;
    }
    if (::tcgetattr(STDIN_FILENO, &saved_terminal) != 0) return;
    termios raw = saved_terminal;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    static const int registered = std::at_quick_exit(&restore_terminal);
    static_cast<void>(registered);
    is_terminal_changed = true;
    has_keys_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
}

Keyboard::~Keyboard() { restore_terminal(); }

std::vector<std::string> Keyboard::read(std::chrono::milliseconds timeout) {
    if (!is_open_) {
        std::this_thread::sleep_for(timeout);
        return {};
    }
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, static_cast<int>(timeout.count())) <= 0) return {};
    char bytes[4096];
    const ssize_t n = ::read(STDIN_FILENO, bytes, sizeof(bytes));
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) return {};
    if (n <= 0) {
        // A terminal that is gone is ready for ever.
        if (has_keys_ && (input.revents & (POLLHUP | POLLERR)) == 0) return {};
        is_open_ = false;
        if (has_keys_) return {};
        pending_ += '\n';  // the last line may lack its end
        return split_lines();
    }
    pending_.append(bytes, static_cast<std::size_t>(n));
    return has_keys_ ? split_keys() : split_lines();
}

std::vector<std::string> Keyboard::split_keys() {
    std::vector<std::string> keys;
    for (std::size_t i = 0; i < pending_.size();) {
        const bool is_arrow = pending_.compare(i, 2, "\x1b[") == 0 && i + 2 < pending_.size();
        keys.push_back(pending_.substr(i, is_arrow ? 3 : 1));
        i += keys.back().size();
    }
    pending_.clear();
    return keys;
}

std::vector<std::string> Keyboard::split_lines() {
    std::vector<std::string> lines;
    for (auto end = pending_.find('\n'); end != std::string::npos; end = pending_.find('\n')) {
        if (end > 0) lines.push_back(pending_.substr(0, end));
        pending_.erase(0, end + 1);
    }
    if (pending_.size() > kMaxLineBytes) pending_.clear();
    return lines;
}

}  // namespace atrium::play
