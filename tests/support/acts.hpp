#pragma once

#include "tests/support/acted_person.hpp"

#include <cstdint>

/// What people do to things in the trials of the world, with everything that may vary drawn from a
/// seed: who, which way they face, where they stand, how fast they begin, how large the thing is.
/// Everybody acts near the middle of the room, +Z up.
namespace atrium::test {

/// Carries something on a palm or a tray: stands with it low, then moves sideways and raises it by
/// a metre each, at 0.5 m/s.
struct CarryAct {
    Act act;
    double start_s = 0.0;  // of the motion; before it everything is still
    double end_s = 0.0;
};
CarryAct carry_on_palm(std::uint64_t seed);
CarryAct carry_on_tray(std::uint64_t seed);

/// Takes something between two palms that face each other some 20 cm apart, lifts it off what it
/// stands on, moves it by a metre and turns it by 90 degrees, all with the whole body.
///
/// One palm is below and one above, up to 20 degrees slanted: so the cameras at the sides see
/// between them. `level`: they are at its right and its left instead, where the trunk behind them
/// or the other hand hides the gap from every camera, and the hull fills it.
struct ClaspAct {
    Act act;
    double width_m = 0.0;   // of the thing, from palm to palm
    double closed_s = 0.0;  // the palms have come together
    double lifted_s = 0.0;
    double end_s = 0.0;  // of the motion
};
ClaspAct clasp_move_turn(std::uint64_t seed, bool level = false);

/// One carries something forwards between the palms, the other takes it in a clasp that crosses
/// the first one's, the first opens the hands and goes back. Both face +X of their rooms;
/// world_from_* place the rooms.
struct HandOverAct {
    Act giver, taker;
    geometry::RigidTransform world_from_giver, world_from_taker;
    double width_m = 0.0;
    double taken_s = 0.0;  // the taker's palms have come together
    double opened_s = 0.0;
    double end_s = 0.0;
};
HandOverAct hand_over(std::uint64_t seed);

/// Throws something forwards that is held between the palms, of which one pushes from behind.
struct ThrowAct {
    Act act;
    double width_m = 0.0;
    double release_s = 0.0;  // the palms open
    double speed_mps = 0.0;  // of the palms then
    Eigen::Vector3d forwards_site;
};
ThrowAct throw_forwards(std::uint64_t seed);

/// Kicks a ball that lies on the floor.
struct KickAct {
    Act act;
    Eigen::Vector3d ball_site;  // its middle
    double diameter_m = 0.0;
    double speed_mps = 0.0;  // of the ankle at the lowest point of its swing
    Eigen::Vector3d forwards_site;
};
KickAct kick(std::uint64_t seed);

/// A hand with an arm, without a person, flat of 4 x 9 x 18 cm, that reaches `speed_mps` in 0.6 m,
/// goes through `target_site` with its palm foremost, turned at random about it and tilted by up to
/// 20 degrees, and stops.
struct StrikeAct {
    Act act;
    double contact_s = 0.0;  // the palm's middle is at the target
    Eigen::Vector3d velocity_site;
    Eigen::Vector3d palm_normal_site;
};
StrikeAct strike(const Eigen::Vector3d& target_site,
                 const Eigen::Vector3d& direction,
                 double speed_mps,
                 std::uint64_t seed);

}  // namespace atrium::test
