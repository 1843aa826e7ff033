// The whole site in this process, from a recording on disk to the real bus.
#include "site_node/site_node.hpp"

#include "tests/support/shapes/rig_maker.hpp"
#include "tests/unit/site_node/capsule_room.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace atrium::site_node {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kNumFrames = 8;

// Four cameras at 20 Hz. "cam1" lacks frames 3 to 5, and nothing comes for half a second after
// frame 5.
class SiteFromRecording : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) / ("atrium_site_node_" + std::to_string(getpid()));
        config::Rig rig;
        rig.cameras = atrium::test::make_ring_rig({.num_cameras = 4,
                                                   .heights_m = {1.0, 2.2},
                                                   .first_angle_rad = 0.3,
                                                   .size_px = 120,
                                                   .focal_px = 125.0});
        for (const auto& camera : rig.cameras) {
            fs::create_directories(folder_ / camera.name / "frames");
            fs::create_directories(folder_ / camera.name / "silhouettes");
        }
        write_rig(rig);
        const auto metaframe = test::take_pictures(test::make_body({0, 0, 0}), rig);
        std::ofstream times(folder_ / "times.csv");
        for (int k = 0; k < kNumFrames; ++k) {
            for (const capture::CameraFrame& frame : metaframe.frames) {
                const std::string& name = rig.cameras[frame.camera].name;
                const std::int64_t time_ms = 50 * k + (k > 5 ? 450 : 0);
                times << k << ',' << name << ',' << time_ms * 1'000'000 << '\n';
                if (name == "cam1" && k >= 3 && k <= 5) continue;
                write(folder_ / name, k, *frame.silhouette);
            }
        }
        config_.name = "lab";
        config_.capture.source = "recording";
        config_.capture.recording = folder_;
        config_.capture.deadline_ms = 300.0;
        config_.bus.world = "site-node-test-" + std::to_string(getpid());
        config_.bus.domain = 181;  // used by this test only
    }
    void TearDown() override { fs::remove_all(folder_); }

    void write_rig(const config::Rig& rig) const {
        std::ofstream file(folder_ / "rig.toml");
        const Eigen::IOFormat row_major(17, Eigen::DontAlignCols, ", ", ", ");
        file << "units = \"m\"\nrate_hz = 20\n";
        for (const auto& camera : rig.cameras) {
            const geometry::PinholeCamera& lens = camera.intrinsics;
            const Eigen::Matrix3d rotation = camera.camera_from_site.rotation.toRotationMatrix();
            const Eigen::RowVector3d translation = camera.camera_from_site.translation.transpose();
            file << "[[camera]]\nname = \"" << camera.name << "\"\nwidth = " << lens.width
                 << "\nheight = " << lens.height << "\nfx = " << lens.fx << "\nfy = " << lens.fy
                 << "\ncx = " << lens.cx << "\ncy = " << lens.cy << "\nrotation = ["
                 << rotation.format(row_major) << "]\ntranslation = ["
                 << translation.format(row_major) << "]\n";
        }
    }

    static void write(const fs::path& folder, int k, const image::Mask& silhouette) {
        const std::string name = cv::format("%06d.png", k);
        const cv::Mat picture(silhouette.height, silhouette.width, CV_8UC3, cv::Scalar(9, 9, 9));
        cv::Mat mask(silhouette.height, silhouette.width, CV_8UC1);
        std::copy(silhouette.data.begin(), silhouette.data.end(), mask.data);
        ASSERT_TRUE(cv::imwrite((folder / "frames" / name).string(), picture));
        ASSERT_TRUE(cv::imwrite((folder / "silhouettes" / name).string(), mask));
    }

    void lose_for_good(const std::string& camera) const {
        for (const int k : {6, 7})
            ASSERT_TRUE(fs::remove(folder_ / camera / "frames" / cv::format("%06d.png", k)));
    }

    std::unique_ptr<SiteNode> run_to_the_end() const {
        auto node = SiteNode::create(config_, {});
        EXPECT_TRUE(node) << node.error().message;
        const auto done = (*node)->run({});
        EXPECT_TRUE(done) << done.error().message;
        return std::move(*node);
    }

    fs::path folder_;
    SiteNodeConfig config_;
};

TEST_F(SiteFromRecording, ContinuesWithoutALostCameraAndCountsIt) {
    config_.capture.min_cameras = 3;
    const auto node = run_to_the_end();
    const bus::SiteStatus status = node->status();
    // three metaframes lack cam1; on a busy machine some pass their deadline together
    EXPECT_GE(status.num_incomplete_used, 1u);
    EXPECT_EQ(status.num_incomplete_used + status.num_dropped_incomplete, 3u);
    EXPECT_EQ(status.num_metaframes_captured, 5u + status.num_incomplete_used);
    EXPECT_EQ(status.num_failed, 0u);
    EXPECT_EQ(status.num_metaframes_published + status.num_dropped_late,
              status.num_metaframes_captured);
    for (const double stage_ms : {status.stages.silhouettes_ms,
                                  status.stages.hull_ms,
                                  status.stages.coding_ms,
                                  status.stages.publishing_ms}) {
        EXPECT_GT(stage_ms, 0.0);
        EXPECT_LT(stage_ms, 60'000.0);
    }
}

TEST_F(SiteFromRecording, DropsIncompleteMetaframesByDefault) {
    const auto node = run_to_the_end();
    EXPECT_EQ(node->status().num_incomplete_used, 0u);
    EXPECT_EQ(node->status().num_dropped_incomplete, 3u);
    const std::vector<bus::CameraStatus> cameras = node->status().cameras;
    ASSERT_EQ(cameras.size(), 4u);
    EXPECT_EQ(cameras[1].name, "cam1");
    EXPECT_EQ(cameras[1].num_incomplete, 3u);
    EXPECT_EQ(cameras[1].num_received, 5u);
    EXPECT_EQ(cameras[0].num_received, 8u);
    EXPECT_GE(cameras[0].last_picture_age_ms, 0.0);
    EXPECT_EQ(node->status().num_metaframes_captured, 5u);
}

TEST_F(SiteFromRecording, UsesMetaframesAfterACameraIsLostForGood) {
    lose_for_good("cam1");
    config_.capture.min_cameras = 3;
    const auto node = run_to_the_end();
    const bus::SiteStatus status = node->status();
    EXPECT_GE(status.num_incomplete_used, 2u);   // one in the gap, and the last one at the end
    EXPECT_GE(status.left_out.num_cameras, 1u);  // nothing can overtake the last one
    EXPECT_LE(status.left_out.num_cameras, status.num_incomplete_used);
    EXPECT_EQ(status.num_incomplete_used + status.num_dropped_incomplete, 5u);
    EXPECT_EQ(status.num_metaframes_captured, 3u + status.num_incomplete_used);
    EXPECT_EQ(status.num_failed, 0u);
    EXPECT_EQ(status.num_metaframes_published + status.num_dropped_late,
              status.num_metaframes_captured);
}

TEST_F(SiteFromRecording, CountsMetaframesWithTooFewCamerasAsFailed) {
    lose_for_good("cam1");
    config_.capture.min_cameras = 3;
    config_.pipeline.hull.min_views = 4;
    const auto node = run_to_the_end();
    const bus::SiteStatus status = node->status();
    EXPECT_GE(status.num_incomplete_used, 2u);
    EXPECT_GE(status.num_failed, 1u);  // nothing can overtake the last one
    EXPECT_EQ(status.num_metaframes_published + status.num_dropped_late + status.num_failed,
              status.num_metaframes_captured);
}

TEST_F(SiteFromRecording, CountsTheFragmentsOfAllMetaframes) {
    config_.pipeline.hull.min_component_l = 1000.0;
    const auto node = run_to_the_end();
    // one each, except for metaframes that were replaced before processing
    EXPECT_EQ(node->status().left_out.num_fragments + node->status().num_dropped_late, 5u);
    EXPECT_GE(node->status().left_out.num_fragments, 1u);  // nothing can overtake the last one
}

TEST_F(SiteFromRecording, RefusesAMinimumAboveTheNumberOfCameras) {
    config_.capture.min_cameras = 5;
    const auto node = SiteNode::create(config_, {});
    ASSERT_FALSE(node);
    EXPECT_EQ(node.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(node.error().message,
                testing::AllOf(HasSubstr("capture.min_cameras"), HasSubstr("4"), HasSubstr("5")));
}

}  // namespace
}  // namespace atrium::site_node
