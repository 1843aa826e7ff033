#pragma once

#include "core/base/expected.hpp"
#include "core/config/option_set.hpp"

#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>

/// Provides the common frame of all programs: command line, configuration file, log, signals, exit
/// codes.
namespace atrium::app {

/// Returns the exit code of an error: 1 failed while running (kInvalidData, kInternal), 2 wrong
/// command line or configuration, 3 something required is missing (kNotFound, kUnavailable). 0 is
/// success.
int exit_code(const Error& error);

/// Version of Atrium, for example "1.2.3".
std::string version();

struct ProgramInfo {
    std::string name;
    std::string summary;   // one or two sentences for --help
    std::string examples;  // shown at the end of --help: command lines, each indented by two spaces
    /// Called after the options are read. True if the program only prints something and ends: its
    /// start line is then logged at level debug only. Empty: false.
    std::function<bool()> only_prints = {};
    std::string exit_codes = {};  // where they differ from the common ones, for --help
    /// Called after all options are read, to check them together. Its error ends the program like a
    /// wrong option. Empty: nothing to check.
    std::function<Expected<void>()> check = {};
    /// What --check looks at besides: all that a start would refuse later, in files that the
    /// options name. Empty: nothing.
    std::function<Expected<void>()> check_files = {};
    /// The option (its key) that an argument without a name sets; empty: there is none.
    std::string positional = {};
};

/// Reads the parts of a configuration file that are not plain options, such as tables of objects.
/// Called after the declared options are read.
using ReadMore = std::function<void(config::TableReader&)>;

/// Result of `start`: whether the program continues, else the exit code with which it ends at once.
struct Start {
    bool go_on = false;
    int exit_code = 0;
};
/// Parses `--config FILE`, `--help`, `--version`, `--log-level`, `--check` and every option of
/// `options`. The command line overrides the file. Prints help, version or the error and tells the
/// program to end; so it does after a --check.
Start start(const ProgramInfo& info,
            const config::OptionSet& options,
            int argc,
            char** argv,
            const ReadMore& read_more = {});

/// Provides a stop token for SIGINT, SIGTERM and SIGHUP. Construct it once, at the top of main,
/// before any thread starts: it blocks the signals in all threads and waits for them in its own. A
/// second signal at least one second after the first ends the process at once.
class StopOnSignal {
public:
    StopOnSignal();
    ~StopOnSignal();
    StopOnSignal(const StopOnSignal&) = delete;
    StopOnSignal& operator=(const StopOnSignal&) = delete;
    std::stop_token token() const;

private:
    struct Impl;
    Impl* impl_;
};

/// Logs the error and returns its exit code.
int fail(const Error& error);

/// Returns the resident memory of this process [bytes]; 0 if unknown.
std::uint64_t resident_bytes();

}  // namespace atrium::app
