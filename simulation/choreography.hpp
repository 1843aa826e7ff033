#pragma once

#include "simulation/skeleton.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::simulation {

/// Motion of a person, as a closed curve of postures.
enum class Motion : std::uint8_t {
    kWave,        // greets with the right hand
    kPush,        // thrusts the right palm forwards at chest height and draws it back
    kWalk,        // walks on the spot
    kStroll,      // walks in a circle through the room
    kSway,        // stands and shifts the weight
    kRaise,       // lifts both arms overhead and lowers them
    kTableHands,  // stands before a table and reaches over its top with both hands
    // play with objects (play_motions.hpp)
    kKick,   // swings the right foot forwards, low over the floor
    kNudge,  // pushes something small off its place with the fingertips of the right hand
    kScoop,  // crouches, dips both hands low in front and flings them up
    kWade,   // goes forwards and back with high knees
    kPart,   // opens a curtain with both hands, steps through it and back
    kCarry,  // reaches below something with both arms, lifts it, turns with it, puts it back
};

/// Finds a motion by its name as above ("wave", "table_hands"); nullopt if there is none.
std::optional<Motion> find_motion(std::string_view name);

std::vector<std::string> motion_names();

/// Returns the posture at `phase`, 0 to 1 over one loop. Phases 0 and 1 give the same posture.
BodyPose posture(Motion motion, double phase);

/// Height of the table top and half its side length [m]. The table's centre is the origin of the
/// body frame of kTableHands.
constexpr double kTableHeightM = 0.75;
constexpr double kTableHalfSideM = 0.5;

}  // namespace atrium::simulation
