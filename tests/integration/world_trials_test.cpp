#include "tests/support/world/world_trials.hpp"

#include "core/config/rig.hpp"
#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

// A few trials of bench/world/world_trials: people carry, hold, hand over and hit. Their hulls come
// from the cameras of a simulated room.
namespace atrium::test {
namespace {

class WorldTrials : public testing::Test {
protected:
    void SetUp() override {
        auto rig = config::load_rig(atrium::test::source_dir() + "/deploy/rigs/full_body.toml");
        ASSERT_TRUE(rig) << rig.error().message;
        setting_.cameras = std::move(rig->cameras);
    }

    template <typename Result>
    static bool succeeds(const Expected<Result>& result) {
        if (!result) {
            ADD_FAILURE() << result.error().message;
            return false;
        }
        if (!result->succeeded) std::printf("%s\n", result->reason.c_str());
        return result->succeeded;
    }

    TrialSetting setting_;
};

TEST_F(WorldTrials, BallStaysOnAMovingTray) {
    EXPECT_TRUE(succeeds(try_carry(setting_, carry_on_tray(0), Thing::kBall, 0)));
}

TEST_F(WorldTrials, BoxStaysOnAMovingPalm) {
    EXPECT_TRUE(succeeds(try_carry(setting_, carry_on_palm(2), Thing::kBox, 2)));
}

TEST_F(WorldTrials, BallBetweenTwoPalmsIsLiftedMovedAndTurned) {
    EXPECT_TRUE(succeeds(try_clasp(setting_, clasp_move_turn(1), Thing::kBall)));
}

TEST_F(WorldTrials, BoxIsHandedOverBetweenPeopleOfTwoSites) {
    EXPECT_TRUE(succeeds(try_hand_over(setting_, hand_over(0), Thing::kBox)));
}

TEST_F(WorldTrials, HandHitsASmallBallAtEverySpeed) {
    for (const double speed : {1.0, 4.0, 8.0}) {
        const auto act = strike({0.0, 0.0, 1.1}, {0.3, -0.8, 0.2}, speed, 0);
        EXPECT_TRUE(succeeds(try_strike(setting_, act))) << speed << " m/s";
    }
}

}  // namespace
}  // namespace atrium::test
