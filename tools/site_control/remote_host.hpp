#pragma once

#include "core/base/expected.hpp"

#include <chrono>
#include <string>
#include <vector>

namespace atrium::site_control {

/// What a shell script printed, and its exit code.
struct Answer {
    int exit_code = 0;
    std::string output;  // of both streams
};

/// Runs `command` with `script` as its standard input, for at most `patience`; then kills it.
/// Errors: kNotFound without such a program, kUnavailable after `patience`.
Expected<Answer> run_script(const std::vector<std::string>& command,
                            const std::string& script,
                            std::chrono::milliseconds patience);

/// The command that reads a script for a host: `ssh HOST sh -s`, or `sh -s` here.
std::vector<std::string> shell_of(const std::string& host,
                                  const std::string& this_host,
                                  const std::vector<std::string>& ssh);

}  // namespace atrium::site_control
