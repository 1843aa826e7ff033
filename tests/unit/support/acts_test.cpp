#include "tests/support/world/acts.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace atrium::test {
namespace {

constexpr std::uint64_t kNumSeeds = 20;
constexpr double kNearlyM = 0.013;

// A hand that cannot reach the place that the act wants presses on objects, or misses them, as no
// person would. The trials would then measure the act, not the physics.
double out_of_reach_m(const Act& act, double until_s) {
    double worst = 0.0;
    for (double t = 0.0; t < until_s; t += 0.05)
        worst = std::max(worst, test::out_of_reach_m(act.pose(t)));
    return worst;
}

TEST(Acts, StayWithinTheReachOfTheArms) {
    for (std::uint64_t seed = 0; seed < kNumSeeds; ++seed) {
        SCOPED_TRACE(seed);
        const CarryAct palm = carry_on_palm(seed);
        EXPECT_LT(out_of_reach_m(palm.act, palm.act.seconds), kNearlyM);
        const CarryAct tray = carry_on_tray(seed);
        EXPECT_LT(out_of_reach_m(tray.act, tray.act.seconds), kNearlyM);
        for (const bool level : {false, true}) {
            const ClaspAct clasp = clasp_move_turn(seed, level);
            EXPECT_LT(out_of_reach_m(clasp.act, clasp.act.seconds), kNearlyM);
        }
        const HandOverAct over = hand_over(seed);
        EXPECT_LT(out_of_reach_m(over.giver, over.giver.seconds), kNearlyM);
        EXPECT_LT(out_of_reach_m(over.taker, over.taker.seconds), kNearlyM);
        const ThrowAct thrown = throw_forwards(seed);
        EXPECT_LT(out_of_reach_m(thrown.act, thrown.release_s), kNearlyM);
    }
}

TEST(Acts, OutOfReachIsTheDistanceThatTheWristLacks) {
    simulation::BodyPose pose;
    EXPECT_LT(test::out_of_reach_m(pose), 1e-9);
    const simulation::RestJoints rest;
    const double arm_m = 0.998 * (rest.upper_arm_m + rest.forearm_m);  // never quite straight
    pose.left_arm.wrist = rest.shoulder + Eigen::Vector3d(0.0, arm_m + 0.1, 0.0);
    EXPECT_NEAR(test::out_of_reach_m(pose), 0.1, 1e-3);  // the rest directions have four digits
}

}  // namespace
}  // namespace atrium::test
