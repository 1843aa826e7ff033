#include "tools/demo/child_process.hpp"

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
#include <fstream>
#include <utility>

namespace atrium::demo {
namespace {

[[noreturn]] void become(char* const* arguments, int log, pid_t parent) {
    // only async-signal-safe calls between fork and exec
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);  // the parent died before prctl took effect
    setpgid(0, 0);  // Ctrl-C reaches only the demo, which stops its children in order
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    execv(arguments[0], arguments);
    _exit(127);
}

// Waits for the end of the process or the timeout, without polling.
bool wait_for_end(pid_t pid, std::chrono::milliseconds patience) {
    const int handle = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
    if (handle < 0) return false;
    pollfd poll_this{handle, POLLIN, 0};
    const int ready = poll(&poll_this, 1, static_cast<int>(patience.count()));
    close(handle);
    return ready > 0;
}

}  // namespace

ChildProcess::ChildProcess(std::string name, std::filesystem::path log_file, pid_t pid)
    : name_(std::move(name)), log_file_(std::move(log_file)), pid_(pid) {}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : name_(std::move(other.name_)),
      log_file_(std::move(other.log_file_)),
      pid_(std::exchange(other.pid_, 0)),
      exit_code_(other.exit_code_) {}

ChildProcess::~ChildProcess() { stop(std::chrono::seconds(5)); }

Expected<ChildProcess> ChildProcess::start(const std::string& name,
                                           const std::vector<std::string>& command,
                                           const std::filesystem::path& log_file) {
    if (access(command.front().c_str(), X_OK) != 0) {
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: no such program", command.front()));
    }
    const int log = open(log_file.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644);
    if (log < 0) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("{}: {}", log_file.string(), std::strerror(errno)));
    }
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const pid_t parent = getpid();
    const pid_t pid = fork();
    if (pid == 0) become(arguments.data(), log, parent);
    close(log);
    if (pid < 0) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("cannot start {}: {}", name, std::strerror(errno)));
    }
    return ChildProcess(name, log_file, pid);
}

std::optional<int> ChildProcess::exit_code() {
    if (exit_code_ || pid_ == 0) return exit_code_;
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
        exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    return exit_code_;
}

int ChildProcess::stop(std::chrono::milliseconds patience) {
    if (pid_ == 0) return 0;
    if (!exit_code()) {
        kill(pid_, SIGTERM);
        if (!wait_for_end(pid_, patience)) kill(pid_, SIGKILL);
        int status = 0;
        if (waitpid(pid_, &status, 0) == pid_) {
            exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        }
    }
    return exit_code_.value_or(0);
}

std::string ChildProcess::log_tail() const {
    constexpr std::streamoff kTail = 65536;
    std::ifstream stream(log_file_, std::ios::binary | std::ios::ate);
    const std::streamoff size = stream.tellg();
    if (size <= 0) return {};
    stream.seekg(std::max<std::streamoff>(0, size - kTail));
    return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace atrium::demo
