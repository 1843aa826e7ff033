#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace atrium {

inline constexpr int kNoSuchProgram = 127;

struct CommandOutput {
    int exit_code = 0;  // kNoSuchProgram: there is none; 128: ended by a signal
    std::string text;   // of both streams
};

/// Runs a program of this host in English, and waits for its end, at most ten seconds: then it is
/// killed. `command` is its name, also one of root's, and its arguments; no shell reads them. It
/// reads `input`. nullopt if this process has no resources left.
std::optional<CommandOutput> run_command(const std::vector<std::string>& command,
                                         std::string_view input = {});

}  // namespace atrium
