#include "viewer/config/viewer_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace atrium::viewer {
namespace {

TEST(ViewerConfig, ReadsPoints) {
    const auto p = parse_point("view.position_m", "1, -2.5,3e-1");
    ASSERT_TRUE(p) << p.error().message;
    EXPECT_EQ(*p, Eigen::Vector3d(1.0, -2.5, 0.3));
}

TEST(ViewerConfig, NamesTheKeyOfABadPoint) {
    for (const char* text : {"", "1,2", "1,2,3,4", "1 2 3", "a,b,c", "1,2,nan", "1,2,3x"}) {
        const auto p = parse_point("view.target_m", text);
        ASSERT_FALSE(p) << text;
        EXPECT_EQ(p.error().kind, ErrorKind::kConfiguration);
        EXPECT_THAT(p.error().message, testing::HasSubstr("view.target_m"));
    }
}

TEST(ViewerConfig, FindsTheDeliveredModelsFromAnyFolder) {
    EXPECT_TRUE(usual_models().is_absolute());
    EXPECT_TRUE(std::filesystem::is_regular_file(usual_models() / "demo.toml")) << usual_models();
}

TEST(ViewerConfig, RefusesATargetAtTheEye) {
    ViewConfig config;
    config.position_m = config.target_m = "1,1,1";
    EXPECT_FALSE(make_view_camera(config));
    EXPECT_TRUE(make_view_camera({}));
}

TEST(VideoSize, KeepsTheAspectRatioIfOneSideIsGiven) {
    const auto size = [](int width, int height, std::pair<int, int> picture) {
        VideoConfig video;
        video.width = width;
        video.height = height;
        return video_size(video, picture);
    };
    EXPECT_EQ(size(0, 0, {960, 540}), std::pair(960, 540));
    EXPECT_EQ(size(320, 0, {960, 540}), std::pair(320, 180));
    EXPECT_EQ(size(0, 270, {960, 540}), std::pair(480, 270));
    EXPECT_EQ(size(100, 300, {960, 540}), std::pair(100, 300));
    EXPECT_EQ(size(333, 0, {961, 541}), std::pair(332, 186)) << "even";
    EXPECT_EQ(size(0, 1, {10, 1000}), std::pair(2, 2));
}

}  // namespace
}  // namespace atrium::viewer
