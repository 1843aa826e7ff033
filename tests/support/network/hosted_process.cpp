#include "tests/support/network/hosted_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

namespace atrium::test {
namespace {

constexpr int kNotStarted = 127;

[[noreturn]] void become(const NetworkHost* host,
                         char* const* arguments,
                         int output,
                         pid_t parent) {
    // only calls that are safe between fork and exec
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    setpgid(0, 0);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    if (host != nullptr && !enter(*host)) _exit(kNotStarted);
    // after the move, because a change of credentials clears this setting
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(kNotStarted);  // the parent ended before prctl took effect
    execv(arguments[0], arguments);
    _exit(kNotStarted);
}

}  // namespace

Expected<std::unique_ptr<HostedProcess>> HostedProcess::start(
    const NetworkHost& host, const std::vector<std::string>& command) {
    return start(&host, command);
}

Expected<std::unique_ptr<HostedProcess>> HostedProcess::start(
    const std::vector<std::string>& command) {
    return start(nullptr, command);
}

Expected<std::unique_ptr<HostedProcess>> HostedProcess::start(
    const NetworkHost* host, const std::vector<std::string>& command) {
    if (access(command.front().c_str(), X_OK) != 0)
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: no such program", command.front()));
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    std::array<int, 2> pipe{};
    if (pipe2(pipe.data(), O_CLOEXEC) != 0)
        return make_error(ErrorKind::kUnavailable, fmt::format("a pipe: {}", std::strerror(errno)));
    const pid_t parent = getpid();
    const pid_t pid = fork();
    if (pid == 0) become(host, arguments.data(), pipe[1], parent);
    close(pipe[1]);
    if (pid < 0) {
        close(pipe[0]);
        return make_error(ErrorKind::kUnavailable, fmt::format("fork: {}", std::strerror(errno)));
    }
    setpgid(pid, pid);  // the child does it too: whichever is first, it is done before we continue
    return std::unique_ptr<HostedProcess>(new HostedProcess(pid, pipe[0]));
}

HostedProcess::HostedProcess(pid_t pid, int pipe)
    : pid_(pid), pipe_(pipe), handle_(static_cast<int>(syscall(SYS_pidfd_open, pid, 0))) {
    fcntl(pipe, F_SETFL, O_NONBLOCK);
    fcntl(handle_.get(), F_SETFD, FD_CLOEXEC);
    collector_ = std::thread([this] { collect(); });
}

HostedProcess::~HostedProcess() {
    if (!exit_code_) {
        kill(-pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    collector_.join();
}

void HostedProcess::signal(int number) {
    if (!exit_code_) kill(-pid_, number);
}

std::optional<int> HostedProcess::wait(std::chrono::milliseconds patience) {
    if (exit_code_) return exit_code_;
    {
        std::unique_lock lock(mutex_);
        if (!more_output_.wait_for(lock, patience, [this] { return has_ended_; })) return {};
    }
    kill(-pid_, SIGKILL);  // its remaining children; the group exists until the process is reaped
    int status = 0;
    if (waitpid(pid_, &status, 0) != pid_) return {};
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return exit_code_;
}

std::string HostedProcess::output() const {
    const std::lock_guard lock(mutex_);
    return output_;
}

bool HostedProcess::wait_for_output(const std::string& text,
                                    std::chrono::milliseconds patience,
                                    std::size_t from) {
    std::unique_lock lock(mutex_);
    const auto is_there = [&] { return output_.find(text, from) != std::string::npos; };
    more_output_.wait_for(lock, patience, [&] { return has_ended_ || is_there(); });
    return is_there();
}

void HostedProcess::collect() {
    // until the process ends; the pipe may stay open in the process's own children
    std::array<pollfd, 2> either{{{pipe_.get(), POLLIN, 0}, {handle_.get(), POLLIN, 0}}};
    for (;;) {
        if (poll(either.data(), either.size(), -1) < 0) continue;
        const bool ended = either[1].revents != 0;
        if (!collect_all()) either[0].fd = -1;  // it closed its streams: nothing more to poll for
        if (!ended) continue;
        const std::lock_guard lock(mutex_);
        has_ended_ = true;
        more_output_.notify_all();
        return;
    }
}

bool HostedProcess::collect_all() {
    for (;;) {
        std::array<char, 8192> buffer;
        const ssize_t num_bytes = read(pipe_.get(), buffer.data(), buffer.size());
        if (num_bytes <= 0) return num_bytes < 0;
        const std::lock_guard lock(mutex_);
        output_.append(buffer.data(), static_cast<std::size_t>(num_bytes));
        more_output_.notify_all();
    }
}

}  // namespace atrium::test
