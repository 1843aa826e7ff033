#include "tests/support/run_program.hpp"

#include <sys/wait.h>

#include <array>
#include <cstdio>

namespace atrium::test_support {

Outcome run_program(const std::string& command_line, int limit_s, const std::string& before) {
    const std::string limited =
        before + "timeout " + std::to_string(limit_s) + " " + command_line + " 2>&1 </dev/null";
    Outcome outcome;
    FILE* pipe = popen(limited.c_str(), "r");
    if (pipe == nullptr) return outcome;
    std::array<char, 4096> buffer;
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
        outcome.output.append(buffer.data(), n);
    const int status = pclose(pipe);
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return outcome;
}

}  // namespace atrium::test_support
