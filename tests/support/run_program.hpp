#pragma once

#include <string>

namespace atrium::test_support {

struct Outcome {
    int exit_code = -1;  // 128 if a signal ended it
    std::string output;  // of both streams
};

/// Runs a command line in a shell, without input. It has its own time limit: a program that hangs
/// fails the test with exit code 124. `before` is a list of shell commands, for example resource
/// limits.
Outcome run_program(const std::string& command_line, int limit_s, const std::string& before = "");

}  // namespace atrium::test_support
