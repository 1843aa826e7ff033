#pragma once

#include "tools/tunnel/tunnel.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace atrium::tunnel_tool::testing {

inline constexpr const char* kCard = "wg-playroom";
inline const std::string kPrivateKey = "yAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=";

/// The tunnel of the hub "hall" or of the spokes "bob" and "alice".
inline keys::Tunnel tunnel_of(const std::string& name) {
    return {"studio.example.org:4711",
            name,
            kPrivateKey,
            {{"hall", "10.200.7.1", "AQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA="},
             {"bob", "10.200.7.2", "AgAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA="},
             {"alice", "10.200.7.3", "AwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA="}}};
}

/// Stands in for a host: answers commands and records them. Commands without an answer succeed
/// silently.
class RecordedCommands {
public:
    /// Answers commands that begin with these words.
    void answer(const std::string& command, int exit_code, const std::string& text = "") {
        answers_[command] = {exit_code, text};
    }

    Run run() {
        return [this](const std::vector<std::string>& command,
                      std::string_view input) -> std::optional<CommandOutput> {
            const std::string line = fmt::format("{}", fmt::join(command, " "));
            commands.push_back(command);
            lines.push_back(line);
            inputs.emplace_back(input);
            // the longest answer is the closest
            for (auto answer = answers_.rbegin(); answer != answers_.rend(); ++answer)
                if (line.starts_with(answer->first)) return answer->second;
            return CommandOutput{};
        };
    }

    std::vector<std::vector<std::string>> commands;
    std::vector<std::string> lines;   // the same with spaces between the words
    std::vector<std::string> inputs;  // of each command

private:
    std::map<std::string, CommandOutput> answers_;
};

}  // namespace atrium::tunnel_tool::testing
