#include "viewer/film/film.hpp"

#include "core/recording/view_path.hpp"
#include "tests/unit/viewer/playback/recorded_site.hpp"
#include "viewer/playback/thumbnails.hpp"
#include "viewer/viewer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <cmath>
#include <fstream>
#include <numbers>
#include <vector>

namespace atrium::viewer {
namespace {

using testing::HasSubstr;

class Film : public RecordedSite {
protected:
    ViewerConfig config() const {
        ViewerConfig config;
        config.recording.file = file_;
        config.headless = true;
        config.view.width = 320;
        config.view.height = 180;
        config.view.position_m = "3,0,1.2";
        config.view.target_m = "0,0,1.2";
        config.view.adapt = "off";
        config.video.file = folder_ / "film.avi";
        config.video.fps = 15.0;
        return config;
    }
    static std::vector<cv::Mat> pictures_of(const std::filesystem::path& file) {
        cv::VideoCapture video(file.string());
        std::vector<cv::Mat> pictures;
        for (cv::Mat picture; video.read(picture);) pictures.push_back(picture.clone());
        return pictures;
    }
    static int grey_at(const cv::Mat& picture, int x, int y) {
        return picture.at<cv::Vec3b>(y, x)[1];
    }
};

TEST_F(Film, HasEachPictureOfItsOwnTime) {
    const auto rendered = render_film(config(), {});
    ASSERT_TRUE(rendered) << rendered.error().message;
    const auto pictures = pictures_of(config().video.file);
    // 29 periods at 30 Hz, two for each picture
    ASSERT_EQ(pictures.size(), 14u);
    for (std::size_t i = 0; i < pictures.size(); ++i)
        EXPECT_NEAR(grey_at(pictures[i], 160, 90), luma_of(2 * static_cast<int>(i)), 7) << i;
}

// An object that comes later has its model from its first picture on, however long that takes.
TEST_F(Film, WaitsForTheModelsOfLaterObjects) {
    constexpr int kComes = 36;  // later than what was there before the recorder
    constexpr int kLast = 45;
    constexpr int kRing = 300;
    {
        std::ofstream model(folder_ / "ball.obj");
        for (int i = 0; i < kRing; ++i) {
            for (int k = 0; k < kRing; ++k) {
                const double a = std::numbers::pi * i / (kRing - 1);
                const double b = 2.0 * std::numbers::pi * k / kRing;
                model << "v " << std::sin(a) * std::cos(b) << ' ' << std::sin(a) * std::sin(b)
                      << ' ' << std::cos(a) << '\n';
            }
        }
        for (int i = 1; i < kRing; ++i) {
            for (int k = 1; k <= kRing; ++k) {
                const int row = kRing * i;
                const int next = k % kRing + 1;
                model << "f " << row - kRing + k << ' ' << row + k << ' ' << row + next << '\n';
                model << "f " << row - kRing + k << ' ' << row + next << ' ' << row - kRing + next
                      << '\n';
            }
        }
    }
    auto writer = recording::WorldWriter::create(
        {.file = folder_ / "late.mcap", .world = "recorded", .host = "test", .version = "1"});
    ASSERT_TRUE(writer) << writer.error().message;
    write(*writer, test_site::description("alice"), 0);
    bus::SceneObject ball;
    ball.object = 1;
    ball.name = "ball";
    ball.shape = bus::Shape::kConvex;
    ball.size_m = {1.0, 1.0, 1.0};
    ball.colour = {1.0, 0.0, 0.0};
    ball.model = "ball.obj";
    ball.model_scale = 0.5;
    ball.world_from_object.translation = {0.0, 0.0, 1.2};
    write(*writer, ball, kComes);
    write(*writer, test_site::description("alice"), kLast);
    ASSERT_TRUE(writer->finish());
    ViewerConfig config = this->config();
    config.recording.file = folder_ / "late.mcap";
    config.models = folder_;
    const auto rendered = render_film(config, {});
    ASSERT_TRUE(rendered) << rendered.error().message;
    const auto pictures = pictures_of(config.video.file);
    ASSERT_EQ(pictures.size(), std::size_t{kLast / 2});
    const auto is_red = [](const cv::Mat& picture, int x, int y) {
        const auto pixel = picture.at<cv::Vec3b>(y, x);
        return pixel[2] > pixel[1] + 60;
    };
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        EXPECT_EQ(is_red(pictures[i], 160, 90), 2 * i >= kComes) << i;
        // the corner of a box, which stands for a model that is being read
        EXPECT_FALSE(is_red(pictures[i], 205, 45)) << i;
    }
}

TEST_F(Film, IsTheSameEachTime) {
    ViewerConfig second = config();
    second.video.file = folder_ / "again.avi";
    ASSERT_TRUE(render_film(config(), {}));
    ASSERT_TRUE(render_film(second, {}));
    const auto a = pictures_of(config().video.file);
    const auto b = pictures_of(second.video.file);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(cv::norm(a[i], b[i], cv::NORM_INF), 0.0);
}

TEST_F(Film, FollowsTheCameraPath) {
    recording::ViewPath path;
    path.add({std::chrono::seconds(0), {3.0, 0.0, 1.2}, {0.0, 0.0, 1.2}, 38.0});
    path.add({std::chrono::milliseconds(900), {3.0, 0.0, 1.2}, {0.0, 3.0, 1.2}, 38.0});
    ViewerConfig config = this->config();
    config.recording.path = folder_ / "path.json";
    ASSERT_TRUE(path.save(config.recording.path));
    const auto rendered = render_film(config, {});
    ASSERT_TRUE(rendered) << rendered.error().message;
    const auto pictures = pictures_of(config.video.file);
    ASSERT_EQ(pictures.size(), 14u);
    EXPECT_NEAR(grey_at(pictures.front(), 160, 90), luma_of(0), 7);
    // turned away to the left of the person: who is in the middle no more
    EXPECT_GT(std::abs(grey_at(pictures.back(), 160, 90) - luma_of(26)), 10);
}

TEST_F(Film, CutsAndSupersamples) {
    ViewerConfig config = this->config();
    config.recording.from_s = 0.4;
    config.recording.to_s = 0.8;
    config.video.fps = 10.0;
    config.video.supersample = 2;
    const auto rendered = render_film(config, {});
    ASSERT_TRUE(rendered) << rendered.error().message;
    const auto pictures = pictures_of(config.video.file);
    ASSERT_EQ(pictures.size(), 4u);
    EXPECT_EQ(pictures[0].size(), cv::Size(320, 180));
    EXPECT_NEAR(grey_at(pictures[0], 160, 90), luma_of(12), 7);
}

TEST_F(Film, SaysWhatIsWrong) {
    ViewerConfig config = this->config();
    config.recording.from_s = 5.0;
    const auto late = render_film(config, {});
    ASSERT_FALSE(late);
    EXPECT_THAT(late.error().message, HasSubstr("behind the end"));
    config = this->config();
    config.recording.path = folder_ / "none.json";
    EXPECT_FALSE(render_film(config, {}));
    config = this->config();
    config.recording.file = folder_ / "none.mcap";
    EXPECT_FALSE(render_film(config, {}));
}

TEST_F(Film, EndsPlayableAtAStop) {
    std::stop_source stop;
    stop.request_stop();
    ASSERT_TRUE(render_film(config(), stop.get_token()));
}

// The picture after a jump is that of playing up to there, bit for bit.
TEST_F(Film, APictureAfterAJumpIsThatOfPlaying) {
    const auto picture = [&](const RecordingConfig& recording, const std::string& name) {
        ViewerConfig config = this->config();
        config.video.file.clear();
        config.recording = recording;
        config.recording.file = file_;
        config.output = folder_ / name;
        config.wait_people = 1;
        config.seconds = 1.5;
        auto viewer = Viewer::create(config);
        EXPECT_TRUE(viewer) << viewer.error().message;
        const auto done = viewer ? (*viewer)->run({}) : Expected<void>();
        EXPECT_TRUE(done) << done.error().message;
        return cv::imread(config.output.string());
    };
    const cv::Mat jumped = picture({.from_s = 0.5, .paused = true}, "jumped.png");
    const cv::Mat played = picture({.from_s = 0.1, .to_s = 0.5}, "played.png");
    ASSERT_FALSE(jumped.empty());
    ASSERT_EQ(jumped.size(), played.size());
    EXPECT_EQ(cv::norm(jumped, played, cv::NORM_INF), 0.0);
    EXPECT_NEAR(grey_at(jumped, 160, 90), luma_of(15), 6);
}

TEST_F(Film, ThumbnailsShowThePeopleOfTheirTime) {
    const auto world = recording::WorldFile::open(file_);
    ASSERT_TRUE(world) << world.error().message;
    const auto shade = [&](int frame) {
        const Thumbnail made = make_thumbnail(*world, begin_ + frame * kPeriod);
        const std::size_t middle =
            4 * (std::size_t{Thumbnail::kHeight / 2} * Thumbnail::kWidth + Thumbnail::kWidth / 2);
        return static_cast<int>(made.rgba.at(middle));
    };
    EXPECT_NEAR(shade(2), luma_of(2), 6);
    EXPECT_NEAR(shade(25), luma_of(25), 6);
    Thumbnails all(*world);
    while (all.revision() < Thumbnails::kNum) std::this_thread::yield();
    for (const Thumbnail& one : all.all()) EXPECT_FALSE(one.rgba.empty());
}

}  // namespace
}  // namespace atrium::viewer
