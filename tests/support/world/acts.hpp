#pragma once

#include "tests/support/world/acted_person.hpp"

#include <cstdint>

/// Acts of people with objects, for the trials of the world. A seed decides everything that varies:
/// the person, the direction, the place, the speed of the start, the size of the object. All act
/// near the middle of the room, +Z up.
namespace atrium::test {

/// Carries an object on a palm or a tray. Stands with it low, then moves it sideways and up by a
/// metre each, at 0.5 m/s.
struct CarryAct {
    Act act;
    double start_s = 0.0;  // of the motion; nothing moves before
    double end_s = 0.0;
};
CarryAct carry_on_palm(std::uint64_t seed);
CarryAct carry_on_tray(std::uint64_t seed);

/// Takes an object between two palms that face each other about 20 cm apart, lifts it off its
/// stand, moves it by a metre and turns it by 90 degrees, all with the whole body.
///
/// One palm is below and one above, slanted by up to 20 degrees, which lets the cameras at the
/// sides see between them. With `level` the palms are at the right and left of the object instead.
/// Then the trunk or the other hand hides the gap from every camera, and the hull fills it.
struct ClaspAct {
    Act act;
    double width_m = 0.0;   // of the object, from palm to palm
    double closed_s = 0.0;  // when the palms have closed
    double lifted_s = 0.0;
    double end_s = 0.0;  // of the motion
};
ClaspAct clasp_move_turn(std::uint64_t seed, bool level = false);

/// The giver carries an object forwards between the palms. The taker clasps it across the giver's
/// clasp. The giver opens the hands and steps back. Both face +X of their rooms, and world_from_*
/// place the rooms.
struct HandOverAct {
    Act giver, taker;
    geometry::RigidTransform world_from_giver, world_from_taker;
    double width_m = 0.0;
    double taken_s = 0.0;  // when the taker's palms have closed
    double opened_s = 0.0;
    double end_s = 0.0;
};
HandOverAct hand_over(std::uint64_t seed);

/// Throws an object held between the palms forwards. One palm pushes from behind.
struct ThrowAct {
    Act act;
    double width_m = 0.0;
    double release_s = 0.0;  // when the palms open
    double speed_mps = 0.0;  // of the palms at that time
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

/// A flat hand of 4 x 9 x 18 cm with an arm, without a person. It reaches `speed_mps` in 0.6 m,
/// passes through `target_site` palm first, turned at random about its direction and tilted by up
/// to 20 degrees, and stops.
struct StrikeAct {
    Act act;
    double contact_s = 0.0;  // when the palm's middle is at the target
    Eigen::Vector3d velocity_site;
    Eigen::Vector3d palm_normal_site;
};
StrikeAct strike(const Eigen::Vector3d& target_site,
                 const Eigen::Vector3d& direction,
                 double speed_mps,
                 std::uint64_t seed);

}  // namespace atrium::test
