#include "tools/simulated_cameras/write_recording.hpp"

#include "core/config/rig.hpp"
#include "site_node/capture/recording_source.hpp"
#include "tests/unit/simulation/rig_fixture.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace atrium::simulated_cameras {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class WriteRecording : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) / fmt::format("atrium-write-{}", getpid());
        fs::create_directories(folder_);
        std::ofstream file(folder_ / "rig.toml");
        file << "units = \"m\"\nrate_hz = 20\n";
        for (const geometry::CalibratedCamera& camera : simulation::ring(2, 64, 48)) {
            const geometry::PinholeCamera& c = camera.intrinsics;
            file << fmt::format(
                "[[camera]]\nname = \"{}\"\nwidth = {}\nheight = {}\nfx = {}\nfy = {}\ncx = {}\n"
                "cy = {}\nrotation = [",
                camera.name,
                c.width,
                c.height,
                c.fx,
                c.fy,
                c.cx,
                c.cy);
            const Eigen::Matrix3d rotation = camera.camera_from_site.rotation.toRotationMatrix();
            for (int i = 0; i < 9; ++i) file << fmt::format("{:.17g}, ", rotation(i / 3, i % 3));
            const Eigen::Vector3d& t = camera.camera_from_site.translation;
            file << fmt::format("]\ntranslation = [{}, {}, {}]\n", t.x(), t.y(), t.z());
        }
        file.close();
        rig_ = *config::load_rig(folder_ / "rig.toml");
        room_.loop_s = 0.2;
        room_.cache.clear();
    }
    void TearDown() override { fs::remove_all(folder_); }

    Expected<void> write(const ShownPictures& shown, double seconds, std::stop_token stop = {}) {
        SerialExecutor executor;
        return write_recording(
            shown, folder_ / "rig.toml", seconds, folder_ / "take", executor, {}, stop);
    }
    ShownPictures shown() const {
        auto made = show_room(rig_, room_, image::PixelFormat::kRgb, {}, {});
        EXPECT_TRUE(made) << made.error().message;
        return *made;
    }

    fs::path folder_;
    config::Rig rig_;
    simulation::RoomConfig room_;
};

// Mean difference of the luma of a picture and of what a camera showed.
double difference_lsb(const image::YuvView& read, const std::vector<std::uint8_t>& rgb) {
    double sum = 0.0;
    for (int y = 0; y < read.y.height; ++y) {
        for (int x = 0; x < read.y.width; ++x) {
            const std::uint8_t* p = rgb.data() + 3 * (y * read.y.width + x);
            sum += std::abs(0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2] - read.y.row(y)[x]);
        }
    }
    return sum / (read.y.width * read.y.height);
}

TEST_F(WriteRecording, IsReadAsWhatTheCamerasShow) {
    room_.late_camera = "cam1";
    const ShownPictures shown = this->shown();
    ASSERT_TRUE(write(shown, 0.3));  // one and a half loops
    auto source = capture::RecordingSource::open({.folder = folder_ / "take"});
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_EQ((*source)->num_frames(), 6u);
    EXPECT_EQ((*source)->rig().cameras[1].name, "cam1");
    image::YuvImage buffer;
    for (std::size_t i = 0; i < 6; ++i) {
        const auto metaframe = (*source)->read_frame(i);
        ASSERT_TRUE(metaframe) << metaframe.error().message;
        ASSERT_EQ(metaframe->frames.size(), 2u);
        for (const capture::CameraFrame& frame : metaframe->frames) {
            const std::size_t instant = (i + (frame.camera == 1 ? 3 : 0)) % 4;
            const image::YuvView read = image::working_view(frame.image, buffer);
            EXPECT_LT(difference_lsb(read, shown.motion[frame.camera][instant]), 2.0);
        }
    }
    std::size_t num_empty = 0;
    const auto count = [&](std::size_t camera, const image::YuvView& read) {
        EXPECT_LT(difference_lsb(read, shown.empty[camera][num_empty % 16]), 2.0);
        ++num_empty;
        return true;
    };
    for (const auto& result : (*source)->show_background({0, 1}, count, {}))
        EXPECT_TRUE(result) << result.error().message;
    EXPECT_EQ(num_empty, 32u);
}

TEST_F(WriteRecording, RendersASweepOfTheWand) {
    room_.shows = "wand";
    ASSERT_TRUE(write(shown(), 0.1));
    const auto source = capture::RecordingSource::open({.folder = folder_ / "take"});
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_EQ((*source)->num_frames(), 2u);
}

TEST_F(WriteRecording, ReplacesNothingAndStopsOnRequest) {
    room_.shows = "wand";
    const ShownPictures shown = this->shown();
    std::stop_source stop;
    stop.request_stop();
    const auto stopped = write(shown, 0.1, stop.get_token());
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().kind, ErrorKind::kUnavailable);
    const auto again = write(shown, 0.1);
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(again.error().message, HasSubstr("exists and is not empty; give a new folder"));
}

}  // namespace
}  // namespace atrium::simulated_cameras
