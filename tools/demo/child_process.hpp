#pragma once

#include "core/base/expected.hpp"

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::demo {

/// Runs a program as a child process and writes its output to a log file. The destructor stops it.
/// The kernel stops it too if this process dies.
class ChildProcess {
public:
    static Expected<ChildProcess> start(const std::string& name,
                                        const std::vector<std::string>& command,
                                        const std::filesystem::path& log_file);
    ChildProcess(ChildProcess&& other) noexcept;
    ChildProcess& operator=(ChildProcess&&) = delete;
    ~ChildProcess();

    const std::string& name() const { return name_; }
    const std::filesystem::path& log_file() const { return log_file_; }

    /// Exit code after the end of the process, or 128 + signal if a signal ended it. Empty while it
    /// runs. Never blocks.
    std::optional<int> exit_code();

    /// Sends SIGTERM, then SIGKILL after `patience`. Returns the exit code.
    int stop(std::chrono::milliseconds patience);

    /// The end of the log, at most 64 kB.
    std::string log_tail() const;

private:
    ChildProcess(std::string name, std::filesystem::path log_file, pid_t pid);
    std::string name_;
    std::filesystem::path log_file_;
    pid_t pid_ = 0;
    std::optional<int> exit_code_;
};

}  // namespace atrium::demo
