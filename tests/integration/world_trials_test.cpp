#include "tests/support/world_trials.hpp"

#include "core/config/rig.hpp"

#include <gtest/gtest.h>

// Those of the trials of bench/world_trials that succeed so far: people whose hulls come from the
// cameras of a simulated room carry and hit.
namespace atrium::test {
namespace {

class WorldTrials : public testing::Test {
protected:
    void SetUp() override {
        auto rig = config::load_rig(ATRIUM_SOURCE_DIR "/deploy/rigs/full_body.toml");
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

TEST_F(WorldTrials, ABallStaysOnATrayThatMovesAndRises) {
    EXPECT_TRUE(succeeds(try_carry(setting_, carry_on_tray(0), Thing::kBall, 0)));
}

TEST_F(WorldTrials, AHandHitsASmallBallAtEverySpeed) {
    for (const double speed : {1.0, 4.0, 8.0}) {
        const auto act = strike({0.0, 0.0, 1.1}, {0.3, -0.8, 0.2}, speed, 0);
        EXPECT_TRUE(succeeds(try_strike(setting_, act))) << speed << " m/s";
    }
}

}  // namespace
}  // namespace atrium::test
