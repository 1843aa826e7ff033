#pragma once

#include <string>

namespace atrium::test_support {

struct Outcome {
    int exit_code = -1;  // 128 where a signal ended it
    std::string output;  // both streams
};

/// Runs a command line in a shell, without input. It has a time limit of its own, so that a program
/// that hangs is a failure of the test: exit code 124. `before`: shell commands, for example limits
/// of its resources.
Outcome run_program(const std::string& command_line, int limit_s, const std::string& before = "");

}  // namespace atrium::test_support
