#pragma once

#include "core/base/expected.hpp"

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::demo {

/// A program that was started and is stopped with this object, whatever happens; its output goes to
/// a log file. The kernel also stops it should this process die.
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

    /// The exit code once it has ended (128 + signal where a signal ended it); never waits.
    std::optional<int> exit_code();

    /// Asks it to end (SIGTERM), and insists (SIGKILL) after `patience`. Returns the exit code.
    int stop(std::chrono::milliseconds patience);

    /// Last line of the log, for telling what it is doing; empty while there is none.
    std::string last_log_line() const;

private:
    ChildProcess(std::string name, std::filesystem::path log_file, pid_t pid);
    std::string name_;
    std::filesystem::path log_file_;
    pid_t pid_ = 0;
    std::optional<int> exit_code_;
};

}  // namespace atrium::demo
