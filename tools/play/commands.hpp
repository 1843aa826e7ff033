#pragma once

#include "core/base/expected.hpp"
#include "core/recording/player.hpp"

#include <string>
#include <string_view>

/// Commands to a player, as lines of JSON or as keys.
namespace atrium::play {

struct CommandResult {
    std::string answer;  // one line of JSON
    bool quits = false;
};

/// Does what a line asks (docs/play.md): {"do": "seek", "time_s": 12.5}. The answer says how the
/// player stands afterwards, or {"error": ...}. After "seek" and "step" it comes once they are
/// shown.
CommandResult obey(recording::Player& player, std::string_view line);

/// The state of a player as one line of JSON.
std::string state_json(const recording::PlayState& state);

/// Does what a key asks: space, arrows ("\x1b[C"), + - l i o, digits, q. Returns false for q.
bool obey_key(recording::Player& player, std::string_view key);

/// "playing 0:12.5 of 10:00.0  x1  loop  in 0:05.0 out 0:20.0".
std::string state_text(const recording::PlayState& state);

}  // namespace atrium::play
