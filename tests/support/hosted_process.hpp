#pragma once

#include "core/base/expected.hpp"
#include "tests/support/network_host.hpp"

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace atrium::test {

/// A program that runs, most often inside a NetworkHost. It leads a process group, which is killed
/// with this object; the kernel kills the program as well should the thread that started it end.
class HostedProcess {
public:
    /// `command`: the program's path and its arguments.
    static Expected<std::unique_ptr<HostedProcess>> start(const NetworkHost& host,
                                                          const std::vector<std::string>& command);
    /// In the network of this process.
    static Expected<std::unique_ptr<HostedProcess>> start(const std::vector<std::string>& command);
    ~HostedProcess();
    HostedProcess(const HostedProcess&) = delete;
    HostedProcess& operator=(const HostedProcess&) = delete;

    pid_t id() const { return pid_; }
    /// To the whole group: SIGSTOP, SIGCONT, SIGTERM, SIGKILL ...
    void signal(int number);
    /// Waits for its end: the exit code, 128 + signal where one ended it; nothing when `patience`
    /// is over.
    std::optional<int> wait(std::chrono::milliseconds patience);
    /// Both streams so far; all of them once `wait` has returned a code.
    std::string output() const;
    /// True once its output contains the text, from the byte `from` on; false when `patience` or
    /// the program has ended.
    bool wait_for_output(const std::string& text,
                         std::chrono::milliseconds patience,
                         std::size_t from = 0);

private:
    static Expected<std::unique_ptr<HostedProcess>> start(const NetworkHost* host,
                                                          const std::vector<std::string>& command);
    HostedProcess(pid_t pid, int pipe);
    void collect();
    bool collect_all();  // that is there; false at the end of the stream

    pid_t pid_;
    Descriptor pipe_;
    Descriptor handle_;  // of the process, readable once it has ended
    std::optional<int> exit_code_;
    mutable std::mutex mutex_;
    std::condition_variable more_output_;
    std::string output_;
    bool has_ended_ = false;
    std::thread collector_;
};

}  // namespace atrium::test
