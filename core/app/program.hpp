#pragma once

#include "core/base/expected.hpp"
#include "core/config/option_set.hpp"

#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>

/// What the programs of Atrium have in common: command line, configuration file, log, Ctrl-C, exit
/// codes.
namespace atrium::app {

// Exit codes: 0 done, 1 failed while running, 2 wrong command line or configuration, 3 something
// needed is not there.
int exit_code(const Error& error);

/// Of Atrium, "1.2.3".
std::string version();

struct ProgramInfo {
    std::string name;
    std::string summary;   // one or two sentences for --help
    std::string examples;  // shown at the end of --help
    /// Asked once the options are read: true where the program only prints something and ends, so
    /// that nobody wants to see all options. Empty: never.
    std::function<bool()> only_prints = {};
};

/// Called after the declared options were read, for the parts of a file that are not plain options
/// (tables of objects, ...).
using ReadMore = std::function<void(config::TableReader&)>;

/// Parses `--config FILE`, `--help`, `--version`, `--log-level`, and every option of `options`; the
/// command line overrides the file. Returns nothing where the program is to go on, or else the exit
/// code to end with at once (help, version, an error, which was printed).
struct Start {
    bool go_on = false;
    int exit_code = 0;
};
Start start(const ProgramInfo& info,
            const config::OptionSet& options,
            int argc,
            char** argv,
            const ReadMore& read_more = {});

/// A stop token that is stopped by SIGINT, SIGTERM or SIGHUP. Call once, at the top of main, before
/// any thread is started: the signals are blocked in all threads and awaited in one of its own. A
/// second signal, a second or more after the first, ends the process at once.
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

/// Resident memory of this process [bytes]; 0 where the system does not tell.
std::uint64_t resident_bytes();

}  // namespace atrium::app
