#include "tools/simulated_cameras/faults.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::simulated_cameras {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

config::Rig three_cameras() {
    config::Rig rig;
    rig.cameras.resize(3);
    rig.cameras[0].name = "left";
    rig.cameras[1].name = "right";
    rig.cameras[2].name = "top";
    return rig;
}

TEST(Faults, AcceptNamesAndNumbersOfCameras) {
    const auto faults = parse_faults({.lose = "right=1,2=50",
                                      .delay_ms = "left=12.5",
                                      .clock_offset_ms = "top=-3",
                                      .stop = "right@2.5+10,0@1+0.5",
                                      .restart = "top@4"},
                                     three_cameras());
    ASSERT_TRUE(faults) << faults.error().message;
    EXPECT_THAT(faults->lost_share, ElementsAre(0.0, 0.01, 0.5));
    EXPECT_THAT(faults->delay_ms, ElementsAre(12.5, 0.0, 0.0));
    EXPECT_THAT(faults->clock_offset_ms, ElementsAre(0.0, 0.0, -3.0));
    ASSERT_EQ(faults->outages.size(), 3u);  // sorted by time
    EXPECT_EQ(faults->outages[0].camera, 0u);
    EXPECT_EQ(faults->outages[1].from_s, 2.5);
    EXPECT_EQ(faults->outages[1].seconds, 10.0);
    EXPECT_EQ(faults->outages[2].camera, 2u);
    EXPECT_EQ(faults->outages[2].seconds, 0.0);
}

TEST(Faults, AreEmptyByDefault) {
    const auto faults = parse_faults({}, three_cameras());
    ASSERT_TRUE(faults);
    EXPECT_THAT(faults->lost_share, ElementsAre(0.0, 0.0, 0.0));
    EXPECT_TRUE(faults->outages.empty());
}

TEST(Faults, NameInvalidEntries) {
    const auto message = [](const FaultTexts& texts) {
        const auto faults = parse_faults(texts, three_cameras());
        return faults ? std::string("accepted") : faults.error().message;
    };
    EXPECT_THAT(message({.lose = "middle=1"}), HasSubstr("no camera 'middle'"));
    EXPECT_THAT(message({.lose = "3=1"}), HasSubstr("no camera '3'"));
    EXPECT_THAT(message({.lose = "left=101"}), HasSubstr("0 to 100"));
    EXPECT_THAT(message({.lose = "left"}), HasSubstr("CAMERA=NUMBER"));
    EXPECT_THAT(message({.lose = "left=1x"}), HasSubstr("left=1x"));
    EXPECT_THAT(message({.delay_ms = "left=-1"}), HasSubstr("delay_ms"));
    EXPECT_THAT(message({.stop = "left@3"}), HasSubstr("CAMERA@FROM+SECONDS"));
    EXPECT_THAT(message({.restart = "left@soon"}), HasSubstr("restart"));
    EXPECT_THAT(message({.stop = "left@3+4", .restart = "left@5"}), HasSubstr("still away"));
}

}  // namespace
}  // namespace atrium::simulated_cameras
