#include "tools/simulated_cameras/command.hpp"

#include "core/base/descriptor.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>

namespace atrium::simulated_cameras {
namespace {

constexpr int kPatience_ms = 10'000;

sigset_t usr1() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGUSR1);
    return set;
}

// Uses only calls that are safe between fork and exec. On failure writes errno to `report`.
[[noreturn]] void become(char* const* arguments, pid_t parent, int report) {
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);  // the parent died before prctl took effect
    execvp(arguments[0], arguments);
    const int error = errno;
    if (write(report, &error, sizeof(error)) < 0) _exit(126);
    _exit(127);
}

// Returns the process id once exec succeeded.
Expected<pid_t> start(const std::vector<std::string>& command) {
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    std::array<int, 2> report{};  // closed by a successful exec
    if (pipe2(report.data(), O_CLOEXEC) != 0)
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("cannot create a pipe: {}", std::strerror(errno)));
    const Descriptor reading(report[0]);
    const pid_t parent = getpid();
    const pid_t pid = fork();
    if (pid == 0) become(arguments.data(), parent, report[1]);
    const int fork_error = errno;
    close(report[1]);
    if (pid < 0) {
        return make_error(
            ErrorKind::kUnavailable,
            fmt::format("cannot start {}: {}", command.front(), std::strerror(fork_error)));
    }
    int exec_error = 0;
    if (read(reading.get(), &exec_error, sizeof(exec_error)) == sizeof(exec_error)) {
        waitpid(pid, nullptr, 0);
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: {}", command.front(), std::strerror(exec_error)));
    }
    return pid;
}

int end_of(pid_t pid) {
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void drain_signals(int descriptor) {
    signalfd_siginfo info{};
    while (read(descriptor, &info, sizeof(info)) == sizeof(info)) {
    }
}

}  // namespace

void block_usr1() {
    const sigset_t set = usr1();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

Expected<int> run_command(const std::vector<std::string>& command,
                          std::stop_token stop,
                          const std::function<void()>& on_signal) {
    const sigset_t set = usr1();
    const Descriptor stopped(eventfd(0, EFD_CLOEXEC));
    const Descriptor signals(signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
    const std::stop_callback wake(stop, [&stopped] {
        const std::uint64_t one = 1;
        if (write(stopped.get(), &one, sizeof(one)) < 0) return;  // the first write cannot fail
    });
    pid_t pid = 0;
    if (!command.empty()) {
        auto started = start(command);
        if (!started) return tl::unexpected(started.error());
        pid = *started;
    }
    const Descriptor process(
        pid == 0 ? -1 : static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));  // -1: never ready
    if (pid != 0 && process.get() < 0) {
        kill(pid, SIGTERM);
        end_of(pid);
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("pidfd_open: {}", std::strerror(errno)));
    }
    std::array<pollfd, 3> awaited{
        {{process.get(), POLLIN, 0}, {stopped.get(), POLLIN, 0}, {signals.get(), POLLIN, 0}}};
    for (;;) {
        if (poll(awaited.data(), awaited.size(), -1) < 0) continue;  // interrupted
        if (awaited[0].revents != 0) return end_of(pid);
        if (awaited[1].revents != 0) break;
        if (awaited[2].revents != 0) {
            drain_signals(signals.get());
            on_signal();
        }
    }
    if (pid == 0) return 0;
    kill(pid, SIGTERM);
    if (poll(awaited.data(), 1, kPatience_ms) == 0) kill(pid, SIGKILL);
    return end_of(pid);
}

}  // namespace atrium::simulated_cameras
