#pragma once

#include "core/base/expected.hpp"
#include "tests/support/network/network_host.hpp"

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace atrium::test {

/// A running program, usually inside a NetworkHost. It leads a process group. The destructor kills
/// the group, and the kernel kills the program if the thread that started it ends.
class HostedProcess {
public:
    /// `command` is the path of the program and its arguments.
    static Expected<std::unique_ptr<HostedProcess>> start(const NetworkHost& host,
                                                          const std::vector<std::string>& command);
    /// Runs in the network of this process.
    static Expected<std::unique_ptr<HostedProcess>> start(const std::vector<std::string>& command);
    ~HostedProcess();
    HostedProcess(const HostedProcess&) = delete;
    HostedProcess& operator=(const HostedProcess&) = delete;

    pid_t id() const { return pid_; }
    /// Sends a signal to the whole group: SIGSTOP, SIGCONT, SIGTERM, SIGKILL ...
    void signal(int number);
    /// Waits for the end. Returns the exit code, or 128 + signal if a signal ended it. Returns
    /// nothing after `patience`.
    std::optional<int> wait(std::chrono::milliseconds patience);
    /// Output of both streams so far. It is complete once `wait` has returned a code.
    std::string output() const;
    /// Waits until the output contains the text, searched from byte `from` on. Returns false after
    /// `patience`, or if the program ends without it.
    bool wait_for_output(const std::string& text,
                         std::chrono::milliseconds patience,
                         std::size_t from = 0);

private:
    static Expected<std::unique_ptr<HostedProcess>> start(const NetworkHost* host,
                                                          const std::vector<std::string>& command);
    HostedProcess(pid_t pid, int pipe);
    void collect();
    bool collect_all();  // reads all available output; false at the end of the stream

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
