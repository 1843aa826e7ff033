#include "site_node/silhouette_writer.hpp"

#include "site_node/capture/mask_file.hpp"
#include "site_node/capture/recording_source.hpp"
#include "site_node/segmentation/background_file.hpp"
#include "site_node/site_node.hpp"
#include "site_node/views/views_file.hpp"
#include "tools/visual_hull/recording_views.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace atrium::site_node {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kWidth = 96;
constexpr int kHeight = 64;

// Two cameras, three metaframes: a red square moves through a grey room. Camera "b" lacks the
// second picture.
class SilhouetteWriter : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) / ("atrium_silhouettes_" + std::to_string(getpid()));
        fs::create_directories(folder_ / "recording");
        std::ofstream rig(folder_ / "recording" / "rig.toml");
        rig << "units = \"m\"\nrate_hz = 20\n";
        for (const char* name : {"a", "b"}) {
            rig << "[[camera]]\nname = \"" << name << "\"\nwidth = 96\nheight = 64\nfx = 100\n"
                << "fy = 100\ncx = 48\ncy = 32\nrotation = [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
                << "translation = [" << (*name == 'a' ? 0.0 : 0.3) << ", 0, 4]\n";
            const fs::path camera = folder_ / "recording" / name;
            fs::create_directories(camera / "frames");
            fs::create_directories(camera / "background");
            const cv::Mat room(kHeight, kWidth, CV_8UC3, cv::Scalar(120, 120, 120));
            for (std::size_t i = 0; i < 3; ++i) {
                write(capture::numbered_png(camera / "background", i), room);
                if (*name == 'b' && i == 1) continue;
                cv::Mat picture = room.clone();
                cv::rectangle(picture, square(i), cv::Scalar(30, 30, 200), cv::FILLED);
                write(capture::numbered_png(camera / "frames", i), picture);
            }
        }
        rig.close();
        config_.recording = folder_ / "recording";
        config_.write_silhouettes = folder_ / "out";
        config_.pipeline.background.folder = folder_ / "learned";
        resolve(config_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    static cv::Rect square(std::size_t frame) {
        return {10 + 20 * static_cast<int>(frame), 16, 20, 30};
    }
    static void write(const fs::path& file, const cv::Mat& picture) {
        ASSERT_TRUE(cv::imwrite(file.string(), picture));
    }

    fs::path folder_;
    SiteNodeConfig config_;
};

TEST_F(SilhouetteWriter, WritesMasksAndPolygonsOfEveryPicture) {
    const auto written = write_silhouettes(config_, {});
    ASSERT_TRUE(written) << written.error().message;
    for (const char* camera : {"a", "b"}) {
        for (std::size_t i = 0; i < 3; ++i) {
            const fs::path file =
                capture::numbered_png(folder_ / "out" / camera / "silhouettes", i);
            if (*camera == 'b' && i == 1) {
                EXPECT_FALSE(fs::exists(file));
                continue;
            }
            const cv::Mat mask = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
            ASSERT_EQ(mask.size(), cv::Size(kWidth, kHeight)) << file;
            EXPECT_EQ(mask.type(), CV_8UC1);
            EXPECT_NEAR(cv::countNonZero(mask), 600, 8) << file;  // without the corners
            EXPECT_EQ(cv::countNonZero(mask(square(i))), cv::countNonZero(mask));
        }
    }
    for (const int i : {0, 1, 2}) {
        const auto views =
            views::load_views_file(folder_ / "out/views" / cv::format("%06d.json", i));
        ASSERT_TRUE(views) << views.error().message;
        ASSERT_EQ(views->size(), i == 1 ? 1u : 2u);
        const views::NamedView& view = views->back();
        EXPECT_EQ(view.name, i == 1 ? "a" : "b");
        EXPECT_EQ(view.view.intrinsics.fx, 100.0);
        EXPECT_EQ(view.view.camera_from_site.translation.x(), i == 1 ? 0.0 : 0.3);
        ASSERT_EQ(view.view.contours.size(), 1u);
        for (const Eigen::Vector2d& p : view.view.contours[0]) {
            EXPECT_GE(p.x(), 9.0 + 20 * i);  // a corner may be off by half a pixel
            EXPECT_LE(p.x(), 30.0 + 20 * i);
        }
    }
}

// visual_hull reads the same options from a site file, and the site computes with them.
TEST_F(SilhouetteWriter, GivesTheContoursOfTheSiteAndOfVisualHull) {
    const fs::path site_file = folder_ / "site.toml";
    std::ofstream(site_file) << "[site]\nname = \"lab\"\n[silhouette]\ntolerance_px = 3\n"
                             << "[segmentation]\nmin_chroma_sigma = 4\n"
                             << "[[segmentation.camera]]\nname = \"a\"\n"
                             << "include = [[0, 0], [20, 5], [25, 60], [0, 64]]\n";
    const auto options = hull_tool::read_silhouette_options(site_file);
    ASSERT_TRUE(options) << options.error().message;
    EXPECT_EQ(options->silhouette.tolerance_px, 3.0);
    static_cast<SilhouetteStageOptions&>(config_.pipeline) = *options;
    ASSERT_TRUE(write_silhouettes(config_, {}));
    const auto written = views::load_views_file(folder_ / "out/views/000000.json");
    ASSERT_TRUE(written) << written.error().message;
    const auto loaded = hull_tool::load_recording_views(config_.recording, 0, {}, *options);
    ASSERT_TRUE(loaded) << loaded.error().message;

    auto source = capture::RecordingSource::open({config_.recording, 0.0, false});
    ASSERT_TRUE(source) << source.error().message;
    auto pipeline = Pipeline::create(**source, config_.pipeline, {});
    ASSERT_TRUE(pipeline) << pipeline.error().message;
    SerialExecutor executor;
    Pipeline::Silhouettes silhouettes;
    ASSERT_TRUE(pipeline->find_silhouettes(*(*source)->read_frame(0), executor, silhouettes));
    for (std::size_t camera = 0; camera < 2; ++camera) {
        const auto& contours = (*loaded)[camera].view.contours;
        ASSERT_EQ(contours.size(), 1u);
        EXPECT_EQ((*written)[camera].view.contours, contours);
        EXPECT_EQ(silhouettes.delivered_outlines(camera), contours);  // the lens does not distort
    }
}

TEST_F(SilhouetteWriter, VisualHullRefusesUnknownKeysOfTheSilhouettes) {
    const fs::path site_file = folder_ / "site.toml";
    std::ofstream(site_file) << "[silhouette]\ntolerance = 3\n";
    const auto options = hull_tool::read_silhouette_options(site_file);
    ASSERT_FALSE(options);
    EXPECT_THAT(options.error().message, HasSubstr("tolerance"));
}

TEST_F(SilhouetteWriter, OverwritesFilesOnlyOnRequest) {
    ASSERT_TRUE(write_silhouettes(config_, {}));
    const auto again = write_silhouettes(config_, {});
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(again.error().message, HasSubstr("--overwrite"));
    config_.overwrite = true;
    EXPECT_TRUE(write_silhouettes(config_, {}));
}

TEST_F(SilhouetteWriter, RefusesAreasOfUnknownCameras) {
    config_.pipeline.areas.push_back({"a", {{{{0, 0}, {20, 0}, {20, 64}, {0, 64}}}, {}}});
    ASSERT_TRUE(write_silhouettes(config_, {}));
    const cv::Mat mask = cv::imread((folder_ / "out/a/silhouettes/000000.png").string(), 0);
    EXPECT_NEAR(cv::countNonZero(mask), 10 * 30, 6);
    config_.overwrite = true;
    config_.pipeline.areas.push_back({"c", {}});
    EXPECT_THAT(write_silhouettes(config_, {}).error().message, HasSubstr("no camera 'c'"));
}

TEST_F(SilhouetteWriter, UsesAPreviouslyLearnedRoom) {
    const auto learned = learn_background(config_, {});
    ASSERT_TRUE(learned) << learned.error().message;
    EXPECT_TRUE(fs::exists(segmentation::background_file(folder_ / "learned", "b")));
    fs::remove_all(folder_ / "recording/a/background");
    fs::remove_all(folder_ / "recording/b/background");
    EXPECT_TRUE(write_silhouettes(config_, {}));
    // a damaged file is an error, never ignored
    std::ofstream(segmentation::background_file(folder_ / "learned", "b")) << "nothing";
    config_.overwrite = true;
    const auto damaged = write_silhouettes(config_, {});
    ASSERT_FALSE(damaged);
    EXPECT_THAT(damaged.error().message, HasSubstr("b.background"));
}

TEST_F(SilhouetteWriter, LearningNeedsAFileToSave) {
    config_.pipeline.background.folder.clear();
    EXPECT_THAT(learn_background(config_, {}).error().message, HasSubstr("background_folder"));
}

TEST_F(SilhouetteWriter, StopEndsLearning) {
    std::stop_source stop;
    stop.request_stop();
    EXPECT_EQ(learn_background(config_, stop.get_token()).error().kind, ErrorKind::kUnavailable);
    EXPECT_FALSE(fs::exists(folder_ / "learned"));
}

}  // namespace
}  // namespace atrium::site_node
