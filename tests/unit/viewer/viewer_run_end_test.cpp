#include "core/presence/join_world.hpp"
#include "tests/unit/viewer/viewer_run.hpp"

#include <gmock/gmock.h>
#include <opencv2/videoio.hpp>

#include <fstream>

namespace atrium::viewer {
namespace {

TEST_F(ViewerRun, EndsAfterTheConfiguredFrames) {
    config_.frames = 5;
    config_.view.max_fps = 200.0;
    start();
    thread_.join();
    ASSERT_TRUE(result_) << result_.error().message;
    EXPECT_EQ(viewer_->status().num_frames, 5u);
    EXPECT_GT(centre_of_output()[0], 50);
}

TEST_F(ViewerRun, VideoBeginsWithTheAwaitedPeople) {
    config_.wait_people = 1;
    config_.wait_timeout_s = 60.0;
    config_.view.max_fps = 200.0;
    config_.video = {.file = folder_ / "new" / "v.avi", .fps = 50.0};
    start();
    ASSERT_TRUE(eventually([&] { return viewer_->status().num_frames > 20; })) << "of nobody";
    Site alice(*this);
    ASSERT_TRUE(show(alice, 2));
    const auto frames = viewer_->status().num_frames;
    ASSERT_TRUE(eventually([&] { return viewer_->status().num_frames > frames + 20; }));
    finish();
    ASSERT_TRUE(result_) << result_.error().message;
    cv::VideoCapture video(config_.video.file.string());
    cv::Mat first;
    ASSERT_TRUE(video.read(first));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(first.at<cv::Vec3b>(90, 160)[i], 230, 12);
}

// As one that learns the empty room.
TEST_F(ViewerRun, NamesASiteThatPublishesNothingYet) {
    config_.wait_people = 1;
    config_.wait_timeout_s = 2.0;
    const auto member = presence::join_world(
        *participant_, bus::ProgramKind::kSiteNode, "cellar", [](const Error&) {}, {});
    ASSERT_TRUE(member) << member.error().message;
    start();
    thread_.join();
    ASSERT_FALSE(result_);
    EXPECT_EQ(result_.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(result_.error().message,
                testing::AllOf(testing::HasSubstr("only 0 of 1 people came within 2 s"),
                               testing::HasSubstr("cellar is a site and publishes nothing yet"),
                               testing::HasSubstr("--wait_timeout_s")));
}

TEST_F(ViewerRun, ReportsUnwritableFilesBeforeTheFirstPicture) {
    const std::filesystem::path no_folder = folder_ / "file";
    std::ofstream(no_folder) << "not a folder";
    config_.output = no_folder / "last.png";
    start();
    thread_.join();
    ASSERT_FALSE(result_);
    EXPECT_THAT(result_.error().message, testing::HasSubstr(config_.output.string()));
    EXPECT_EQ(viewer_->status().num_frames, 0u);
    config_.output.clear();
    config_.video.file = no_folder / "v.avi";
    start();
    thread_.join();
    ASSERT_FALSE(result_);
    EXPECT_THAT(result_.error().message, testing::HasSubstr(config_.video.file.string()));
    config_.video.file = folder_ / "v.gif";
    const auto misnamed = Viewer::create(config_);
    ASSERT_FALSE(misnamed);
    EXPECT_EQ(misnamed.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(misnamed.error().message, testing::HasSubstr("video.file: must end in"));
}

TEST_F(ViewerRun, RefusesTwoEyesWithoutAWindow) {
    config_.display.stereo = "quad_buffer";
    const auto viewer = Viewer::create(config_);
    ASSERT_FALSE(viewer);
    EXPECT_EQ(viewer.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(viewer.error().message, testing::HasSubstr("quad_buffer needs a window"));
}

TEST_F(ViewerRun, FailsIfNobodyComes) {
    config_.wait_people = 2;
    config_.frames = 1;
    config_.wait_timeout_s = 0.2;
    start();
    thread_.join();
    ASSERT_FALSE(result_);
    EXPECT_EQ(result_.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(result_.error().message, testing::HasSubstr("0 of 2 people"));
}

}  // namespace
}  // namespace atrium::viewer
