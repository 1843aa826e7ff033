#include "core/bus/bus.hpp"
#include "core/presence/membership.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/virtual_display.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <optional>
#include <sstream>
#include <string>

// The viewer as a user starts it, in a window on a private display, with keys and mouse.
namespace atrium {
namespace {

namespace fs = std::filesystem;
using test_support::comes_true;
using test_support::Outcome;
using test_support::VirtualDisplay;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

constexpr const char* kTitle = "Atrium";
constexpr std::uint32_t kDomain = 184;  // used by this test only
constexpr double kVideoHz = 20.0;
const cv::Size kSize(640, 360);
const cv::Size kLargerSize(800, 450);
// A point on the box, one in the sky and one on the floor, away from the figures.
const cv::Point kBoxAt(320, 180);
const cv::Point kSkyAt(620, 10);
const cv::Point kFloorAt(620, 350);

class ViewerProgram : public testing::Test {
protected:
    void SetUp() override {
        auto started = VirtualDisplay::start(1280, 800);
        if (!started) GTEST_SKIP() << atrium::test::skip::kNoDisplay << started.error().message;
        display_ = std::move(*started);
        fs::create_directories(folder_);
        put_a_red_box();
        prepare();
        program_ = std::async(std::launch::async, [this] {
            const std::string state =
                "export XDG_STATE_HOME=" + (folder_ / "state").string() + "; ";
            return test_support::run_program(command_line(), 200, state);
        });
        ASSERT_TRUE(comes_true([&] {
            join();
            return shows_the_box();
        })) << log();
    }
    bool shows_the_box() {
        const auto colour = display_->colour_in(kTitle, kBoxAt.x, kBoxAt.y);
        return colour && (*colour)[0] > 2 * (*colour)[1];
    }
    void TearDown() override {
        if (program_.valid()) {
            press_escape_twice();
            program_.wait();
        }
        fs::remove_all(folder_);
    }

    void put_a_red_box() {
        bus::BusOptions options;
        options.world = "viewer-program-test";
        options.domain = kDomain;
        auto participant = bus::Participant::create(options);
        ASSERT_TRUE(participant) << participant.error().message;
        participant_.emplace(std::move(*participant));
        auto objects = bus::Writer<bus::SceneObject>::create(*participant_);
        ASSERT_TRUE(objects) << objects.error().message;
        objects_.emplace(std::move(*objects));
        bus::SceneObject box;
        box.object = 1;
        box.name = "box";
        box.shape = bus::Shape::kBox;
        box.size_m = {0.5, 0.5, 0.5};
        box.colour = {0.9, 0.02, 0.02};
        box.world_from_object.translation = {0.0, 0.0, 1.0};
        ASSERT_TRUE(objects_->write(box));
    }
    std::string command_line() const {
        std::ostringstream command;
        command
            << ATRIUM_BIN_DIR "/viewer " << world_option() << " --bus.domain " << kDomain
            << " --view.width " << kSize.width << " --view.height " << kSize.height
            << " --view.position_m 3,0,1 --view.target_m 0,0,1 --video.fps " << kVideoHz
            << " --view.name tester --view.adapt off"  // a busy machine must not change the picture
            << " --screenshot_dir " << folder_.string() << " > " << log_file().string();
        return command.str();
    }
    virtual std::string world_option() const { return "--bus.world viewer-program-test"; }
    /// Called before the viewer is started.
    virtual void prepare() {}
    /// Called while the viewer does not show the world yet.
    virtual void join() {}
    fs::path log_file() const { return folder_ / "log"; }
    std::string log() const {
        std::ostringstream text;
        text << std::ifstream(log_file()).rdbuf();
        return text.str();
    }
    /// The last value in the log after that word. Empty without one.
    fs::path file_in_log(const std::string& word) const {
        std::istringstream lines(log());
        fs::path file;
        for (std::string line; std::getline(lines, line);) {
            const auto at = line.find(word);
            if (at != std::string::npos) file = line.substr(at + word.size());
        }
        return file;
    }
    /// Waits for a file in the log other than `before`, after that key was pressed.
    fs::path file_after(const std::string& key, const std::string& word, const fs::path& before) {
        display_->press(kTitle, key);
        fs::path file;
        EXPECT_TRUE(comes_true([&] {
            file = file_in_log(word);
            return file != before;
        })) << key
            << '\n'
            << log();
        return file;
    }
    cv::Mat screenshot_after(const std::string& key) {
        last_screenshot_ = file_after(key, "screenshot in ", last_screenshot_);
        EXPECT_EQ(last_screenshot_.parent_path(), folder_);
        return cv::imread(last_screenshot_.string());
    }
    bool shows(const cv::Mat& picture, const cv::Point& at) {
        const auto colour = display_->colour_in(kTitle, at.x, at.y);
        const cv::Vec3b bgr = picture.at<cv::Vec3b>(at);
        return colour && *colour == VirtualDisplay::Colour{bgr[2], bgr[1], bgr[0]};
    }
    Outcome close() {
        press_escape_twice();
        return program_.get();
    }
    // once asks, twice closes
    void press_escape_twice() {
        for (int i = 0; i < 2; ++i) display_->press_escape(kTitle);
    }

    const fs::path folder_ =
        fs::temp_directory_path() / ("atrium_viewer_program_" + std::to_string(getpid()));
    std::unique_ptr<VirtualDisplay> display_;
    std::optional<bus::Participant> participant_;
    std::optional<bus::Writer<bus::SceneObject>> objects_;
    fs::path last_screenshot_;
    std::future<Outcome> program_;
};

// Expects a red box in front of sky and floor, at any size of the picture.
void expect_the_scene(const cv::Mat& bgr) {
    ASSERT_FALSE(bgr.empty());
    const cv::Vec3b box = bgr.at<cv::Vec3b>(bgr.rows / 2, bgr.cols / 2);
    EXPECT_GT(box[2], 100);
    EXPECT_GT(box[2], 2 * box[1]);
    const cv::Vec3b sky = bgr.at<cv::Vec3b>(10, bgr.cols - 20);
    const cv::Vec3b floor = bgr.at<cv::Vec3b>(bgr.rows - 10, bgr.cols - 20);
    EXPECT_GT(cv::norm(sky, floor), 10.0);
    EXPECT_LT(std::abs(sky[2] - sky[1]), 60) << "the sky must not be red";
    cv::Scalar mean, deviation;
    cv::meanStdDev(bgr, mean, deviation);
    EXPECT_GT(deviation[1], 10.0);
}

TEST_F(ViewerProgram, TakesScreenshotsOfItsWindow) {
    const cv::Mat first = screenshot_after("F12");
    ASSERT_EQ(first.size(), kSize);
    expect_the_scene(first);
    // nothing moves: the screen shows the picture of the screenshot, at the latest with the next
    // one
    for (const cv::Point& at : {kBoxAt, kSkyAt, kFloorAt})
        EXPECT_TRUE(comes_true([&] { return shows(first, at); })) << at;

    display_->resize(kTitle, {kLargerSize.width, kLargerSize.height});
    cv::Mat second;
    const cv::Point corner(kLargerSize.width - 10, 10);
    ASSERT_TRUE(comes_true([&] {
        second = screenshot_after("p");
        return second.size() == kLargerSize;
    }));
    expect_the_scene(second);
    EXPECT_TRUE(comes_true([&] { return shows(second, corner); }));

    // a drag over the floor moves the view around the box
    display_->point_at(kTitle, 700, 420);
    display_->hold_button(kTitle, true);
    EXPECT_TRUE(comes_true([&] {
        display_->point_at(kTitle, 600, 420);
        display_->point_at(kTitle, 700, 440);
        const auto floor = display_->colour_in(kTitle, 400, 120);
        const cv::Vec3b before = second.at<cv::Vec3b>(120, 400);
        return floor && *floor != VirtualDisplay::Colour{before[2], before[1], before[0]};
    }));
    display_->hold_button(kTitle, false);

    const Outcome outcome = close();
    EXPECT_EQ(outcome.exit_code, 0) << log();
    EXPECT_THAT(log(), HasSubstr("surface_open on=\"window"));
    EXPECT_FALSE(display_->size_of(kTitle));
}

struct Video {
    int num_frames = 0;
    double frames_per_s = 0.0;
    cv::Mat last;
};

Video read_video(const fs::path& file) {
    Video video;
    cv::VideoCapture capture(file.string());
    video.frames_per_s = capture.get(cv::CAP_PROP_FPS);
    for (cv::Mat frame; capture.read(frame); ++video.num_frames) {
        EXPECT_EQ(frame.size(), kSize);
        video.last = frame.clone();
    }
    return video;
}

TEST_F(ViewerProgram, RecordsVideosBetweenKeysAndUntilClosed) {
    // several pictures in each: 20 kB hold no more than two or three
    const auto has_grown = [](const fs::path& file) {
        std::error_code failure;
        return fs::file_size(file, failure) > 100'000 && !failure;
    };
    const Clock::time_point asked = Clock::now();
    const fs::path first = file_after("F9", "recording into ", {});
    const Clock::time_point begun = Clock::now();
    ASSERT_TRUE(comes_true([&] { return has_grown(first); }));
    const double least_s = std::chrono::duration<double>(Clock::now() - begun).count();
    EXPECT_EQ(file_after("F9", "video in ", {}), first);
    const double most_s = std::chrono::duration<double>(Clock::now() - asked).count();

    const fs::path second = file_after("F9", "recording into ", first);
    ASSERT_TRUE(comes_true([&] { return has_grown(second); }));
    const Outcome outcome = close();
    EXPECT_EQ(outcome.exit_code, 0) << log();
    EXPECT_FALSE(display_->size_of(kTitle));

    const Video ended_by_key = read_video(first);
    expect_the_scene(ended_by_key.last);
    EXPECT_NEAR(ended_by_key.frames_per_s, kVideoHz, 0.01);
    // as long as the recording: one picture at each end may be missing, and half of them on a busy
    // machine
    EXPECT_LE(ended_by_key.num_frames, most_s * kVideoHz + 2.0);
    EXPECT_GE(ended_by_key.num_frames, 0.5 * least_s * kVideoHz - 1.0);
    EXPECT_GT(ended_by_key.num_frames, 1);
    const Video ended_by_closing = read_video(second);
    expect_the_scene(ended_by_closing.last);
    EXPECT_GT(ended_by_closing.num_frames, 1);
}

// Without a world, the user chooses one.
class ViewerStart : public ViewerProgram {
protected:
    std::string world_option() const override { return ""; }
    void prepare() override {
        const auto ignore = [](const std::string&) {};
        auto member = presence::Membership::join(*participant_,
                                                 {bus::ProgramKind::kWorldServer, "boxes", "1"},
                                                 {ignore, ignore, [](const Error&) {}});
        ASSERT_TRUE(member) << member.error().message;
        member_ = std::move(*member);
    }
    // chooses the only world, as soon as it is heard
    void join() override { display_->press(kTitle, "Return"); }

    std::unique_ptr<presence::Membership> member_;
};

TEST_F(ViewerStart, JoinsTheChosenWorldAndComesBackForAnother) {
    const VirtualDisplay::Size size{kSize.width, kSize.height};
    EXPECT_EQ(display_->size_of(kTitle), size);
    EXPECT_TRUE(display_->size_of("viewer-program-test - tester - Atrium"));
    const fs::path before = file_after("F12", "screenshot in ", {});
    display_->press(kTitle, "BackSpace");
    EXPECT_TRUE(comes_true([&] { return !shows_the_box(); })) << log();
    EXPECT_EQ(display_->size_of(kTitle), size) << "the window stays";
    EXPECT_FALSE(display_->size_of("viewer-program-test - tester - Atrium"));
    // the world is gone, but remembered
    member_.reset();
    EXPECT_TRUE(comes_true([&] {
        join();
        return shows_the_box();
    })) << log();
    // pictures of the world before are kept
    EXPECT_NE(file_after("F12", "screenshot in ", before), before);
    const Outcome outcome = close();
    EXPECT_EQ(outcome.exit_code, 0) << log();
    EXPECT_THAT(log(), HasSubstr("world_chosen world=viewer-program-test"));
    EXPECT_TRUE(fs::exists(folder_ / "state/atrium/recent_worlds.toml"));
}

TEST_F(ViewerStart, PrintsTheWorldsWithoutADisplay) {
    const std::string viewer = ATRIUM_BIN_DIR "/viewer --bus.domain " + std::to_string(kDomain);
    const Outcome heard = test_support::run_program(viewer, 60, "unset DISPLAY; ");
    EXPECT_EQ(heard.exit_code, 0) << heard.output;
    EXPECT_THAT(heard.output, HasSubstr("viewer-program-test"));
    EXPECT_THAT(heard.output, HasSubstr("world server on "));
    EXPECT_THAT(heard.output,
                HasSubstr("viewer --bus.world viewer-program-test --bus.domain " +
                          std::to_string(kDomain)));
}

// The requested context draws, or the program names what is missing.
class ViewerContext : public testing::Test {
protected:
    static Outcome run(const std::string& options, const std::string& before = "") {
        return test_support::run_program(ATRIUM_BIN_DIR "/viewer --frames 1 --bus.domain " +
                                             std::to_string(kDomain) + " " + options,
                                         60,
                                         "unset DISPLAY; " + before);
    }
    // of libEGL, which then finds no driver
    const std::string no_driver_ = "export __EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent.json; ";
};

TEST_F(ViewerContext, DrawsWithOsmesaOrEglOnRequest) {
    const Outcome osmesa = run("--view.context osmesa");
    EXPECT_EQ(osmesa.exit_code, 0) << osmesa.output;
    EXPECT_THAT(osmesa.output, HasSubstr("surface_open on=\"OSMesa, llvmpipe"));
    const Outcome egl = run("--view.context egl");
    if (egl.exit_code == 3) GTEST_SKIP() << atrium::test::skip::kNoEgl << egl.output;
    EXPECT_EQ(egl.exit_code, 0) << egl.output;
    EXPECT_THAT(egl.output, HasSubstr("surface_open on=\"EGL, "));
}

TEST_F(ViewerContext, NamesAMissingDriver) {
    const Outcome egl = run("--view.context egl", no_driver_);
    EXPECT_EQ(egl.exit_code, 3) << egl.output;
    EXPECT_THAT(egl.output, HasSubstr("EGL: no driver"));
    const Outcome window = run("--view.context window");
    EXPECT_EQ(window.exit_code, 3) << window.output;
    EXPECT_THAT(window.output, HasSubstr("DISPLAY is not set"));
    const Outcome neither = run("--view.context window --headless");
    EXPECT_EQ(neither.exit_code, 2) << neither.output;
    EXPECT_THAT(neither.output, HasSubstr("view.context"));
}

TEST_F(ViewerContext, IsOsmesaWithoutAGpuAndTheLogSaysWhy) {
    const Outcome outcome = run("--headless", no_driver_);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output,
                testing::AllOf(HasSubstr("surface_software reason=\"EGL: no driver"),
                               HasSubstr("surface_open on=\"OSMesa, ")));
}

}  // namespace
}  // namespace atrium
