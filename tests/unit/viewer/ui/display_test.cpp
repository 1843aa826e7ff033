#include "viewer/ui/display.hpp"

#include "tests/support/source_dir.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

namespace atrium::viewer {
namespace {

using renderer::EyeView;
using renderer::Screen;
using renderer::ViewCamera;

Eigen::Vector2d ndc(const EyeView& eye, const Eigen::Vector3d& p_world) {
    const Eigen::Vector4d clip = eye.clip_from_world() * p_world.homogeneous();
    return clip.head<2>() / clip.w();
}

Display make(const DisplayConfig& config) {
    auto display = Display::create(config);
    if (!display) ADD_FAILURE() << display.error().message;
    return display ? *display : Display{};
}

TEST(Screen, FillsTheViewOfAnyEyeInFrontOfIt) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    for (int round = 0; round < 200; ++round) {
        const Eigen::Quaterniond turn = Eigen::Quaterniond::UnitRandom();
        const Eigen::Vector3d middle(number(random), number(random), number(random));
        const double half_width_m = 0.2 + std::abs(number(random));
        const double half_height_m = 0.2 + std::abs(number(random));
        const auto place = [&](double x, double y, double z) -> Eigen::Vector3d {
            return middle + turn * Eigen::Vector3d(x, y, z);
        };
        const Screen screen{place(-half_width_m, -half_height_m, 0),
                            place(half_width_m, -half_height_m, 0),
                            place(-half_width_m, half_height_m, 0)};
        const Eigen::Vector3d eye_m =
            place(2.0 * number(random), 2.0 * number(random), 0.3 + std::abs(number(random)));
        const EyeView eye = renderer::eye_through(screen, eye_m, 0.05, 50.0, {0, 0, 4, 3});
        EXPECT_LT((eye.eye_world() - eye_m).norm(), 1e-9);
        EXPECT_LT((ndc(eye, screen.lower_left_m) - Eigen::Vector2d(-1, -1)).norm(), 1e-9);
        EXPECT_LT((ndc(eye, screen.lower_right_m) - Eigen::Vector2d(1, -1)).norm(), 1e-9);
        EXPECT_LT((ndc(eye, screen.upper_left_m) - Eigen::Vector2d(-1, 1)).norm(), 1e-9);
        // a point behind the screen on the ray through its corner appears there as well
        const Eigen::Vector3d beyond = eye_m + 3.0 * (screen.lower_left_m - eye_m);
        EXPECT_LT((ndc(eye, beyond) - Eigen::Vector2d(-1, -1)).norm(), 1e-9);
    }
}

TEST(Screen, OfACameraShowsTheViewOfTheCamera) {
    const ViewCamera camera{.position_m = {2, -3, 1.7}, .target_m = {0.3, 0.2, 1.0}};
    const EyeView whole = renderer::eye_of(camera, 960, 540);
    const EyeView through = renderer::eye_through(renderer::screen_of(camera, 960.0 / 540.0, 2.5),
                                                  camera.position_m,
                                                  camera.near_m,
                                                  camera.far_m,
                                                  {0, 0, 960, 540});
    EXPECT_TRUE(through.clip_from_world().isApprox(whole.clip_from_world(), 1e-9));
    EXPECT_LT((whole.eye_world() - camera.position_m).norm(), 1e-12);
}

TEST(Display, ShowsOneEyeOnAWholeMonitor) {
    const ViewCamera camera;
    const auto eyes = make({}).eyes(camera, 640, 360);
    ASSERT_EQ(eyes.size(), 1U);
    EXPECT_EQ(eyes[0].part_px, (image::PixelRect{0, 0, 640, 360}));
    EXPECT_EQ(make({}).instant({1'000'000'000}), std::nullopt)
        << "a single viewer must show the newest";
}

TEST(Display, GivesEachEyeItsPart) {
    const ViewCamera camera;
    const auto parts = [&](const char* stereo) {
        const Display display = make({.stereo = stereo});
        const auto [width, height] = display.picture_size({641, 361});
        const auto eyes = display.eyes(camera, width, height);
        EXPECT_EQ(eyes.size(), 2U);
        return std::pair{eyes[0].part_px, eyes[1].part_px};
    };
    using Rect = image::PixelRect;
    EXPECT_EQ(parts("side_by_side"), std::pair(Rect{0, 0, 320, 361}, Rect{320, 0, 321, 361}));
    EXPECT_EQ(parts("top_bottom"), std::pair(Rect{0, 0, 641, 180}, Rect{0, 180, 641, 181}));
    EXPECT_EQ(parts("anaglyph"), std::pair(Rect{0, 0, 641, 361}, Rect{0, 0, 641, 361}));
    EXPECT_EQ(parts("quad_buffer"), std::pair(Rect{0, 0, 641, 361}, Rect{641, 0, 641, 361}));
    const auto eyes = make({.stereo = "anaglyph"}).eyes(camera, 64, 36);
    EXPECT_EQ(eyes[0].writes, (std::array{true, false, false}));
    EXPECT_EQ(eyes[1].writes, (std::array{false, true, true}));
}

TEST(Display, SeparatesTheEyesAndKeepsTheTarget) {
    const ViewCamera camera{.position_m = {0, -4, 1.5}, .target_m = {0, 0, 1.5}};
    for (const char* stereo : {"side_by_side", "top_bottom", "anaglyph", "quad_buffer"}) {
        const Display display = make({.stereo = stereo, .eye_distance_m = 0.07});
        const auto [width, height] = display.picture_size({800, 450});
        const auto eyes = display.eyes(camera, width, height);
        EXPECT_NEAR(eyes[0].eye_world().x(), -0.035, 1e-12) << "the left eye must come first";
        EXPECT_NEAR(eyes[1].eye_world().x(), 0.035, 1e-12);
        EXPECT_LT(ndc(eyes[0], camera.target_m).norm(), 1e-9);
        EXPECT_LT(ndc(eyes[1], camera.target_m).norm(), 1e-9);
        // a nearer point is in front of the screen: further right for the left eye
        const Eigen::Vector3d near(0, -2, 1.5);
        EXPECT_GT(ndc(eyes[0], near).x() - ndc(eyes[1], near).x(), 0.01);
        const Eigen::Vector3d far(0, 4, 1.5);
        EXPECT_LT(ndc(eyes[0], far).x() - ndc(eyes[1], far).x(), -0.005);
    }
    const Display nearer = make({.stereo = "anaglyph", .convergence_m = 2.0});
    const auto eyes = nearer.eyes(camera, 800, 450);
    const Eigen::Vector3d at_2m(0.3, -2, 1.2);
    EXPECT_LT((ndc(eyes[0], at_2m) - ndc(eyes[1], at_2m)).norm(), 1e-9);
}

TEST(Display, FindsThePictureUnderThePointer) {
    const auto over = [](const char* stereo, double x, double y) {
        return make({.stereo = stereo})
            .over_one_eye({.at_px = {x, y}, .width_px = 800, .height_px = 400})
            .at_px;
    };
    EXPECT_EQ(over("none", 700, 300), Eigen::Vector2d(700, 300));
    EXPECT_EQ(over("side_by_side", 100, 300), Eigen::Vector2d(200, 300));
    EXPECT_EQ(over("side_by_side", 500, 300), Eigen::Vector2d(200, 300));
    EXPECT_EQ(over("top_bottom", 100, 300), Eigen::Vector2d(100, 200));
    EXPECT_EQ(over("anaglyph", 500, 300), Eigen::Vector2d(500, 300));
}

class DisplayWall : public testing::Test {
protected:
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path write(const std::string& text) {
        const auto file = folder_ / "wall.toml";
        std::ofstream(file) << text;
        return file;
    }
    std::string refused(const std::string& text, const std::string& tile = "left") {
        const auto display = Display::create({.wall = write(text), .tile = tile});
        EXPECT_FALSE(display);
        if (display) return "";
        EXPECT_EQ(display.error().kind, ErrorKind::kConfiguration);
        return display.error().message;
    }
    static std::string tile(const std::string& name, double left, double right) {
        return "[[tile]]\nname = \"" + name + "\"\nlower_left_m = [" + std::to_string(left) +
               ", 0, 0.5]\nlower_right_m = [" + std::to_string(right) +
               ", 0, 0.5]\nupper_left_m = [" + std::to_string(left) + ", 0, 2.0]\n";
    }

    const std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("atrium-wall-" + std::to_string(getpid()));
};

TEST_F(DisplayWall, IsOneWindowIntoTheWorldAcrossItsTiles) {
    const auto file =
        write("[wall]\nposition_m = [1, -2, 0]\nyaw_deg = 30\neye_m = [0.4, -1.5, 1.6]\n" +
              tile("left", -2.0, 0.0) + tile("right", 0.0, 2.0));
    const EyeView left = make({.wall = file, .tile = "left"}).eyes({}, 800, 600)[0];
    const EyeView right = make({.wall = file, .tile = "right"}).eyes({}, 800, 600)[0];
    EXPECT_LT((left.eye_world() - right.eye_world()).norm(), 1e-12);
    const double yaw_rad = M_PI / 6.0;
    const Eigen::Vector3d eye(1.0 + 0.4 * std::cos(yaw_rad) + 1.5 * std::sin(yaw_rad),
                              -2.0 + 0.4 * std::sin(yaw_rad) - 1.5 * std::cos(yaw_rad),
                              1.6);
    EXPECT_LT((left.eye_world() - eye).norm(), 1e-9);
    // an object that leaves one tile at its edge enters the other
    std::mt19937 random(4);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    for (int round = 0; round < 100; ++round) {
        const Eigen::Vector3d p(3.0 * number(random), 4.0 + number(random), 1.5 * number(random));
        const Eigen::Vector2d in_left = ndc(left, p), in_right = ndc(right, p);
        EXPECT_NEAR(in_left.x() - 1.0, in_right.x() + 1.0, 1e-9);
        EXPECT_NEAR(in_left.y(), in_right.y(), 1e-9);
    }
}

TEST_F(DisplayWall, ChecksTheAspectRatioOfATile) {
    const auto file = write(tile("left", -2.0, 0.0));  // 2 m by 1.5 m
    for (const char* stereo : {"none", "side_by_side", "quad_buffer"}) {
        const Display display = make({.stereo = stereo, .wall = file, .tile = "left"});
        EXPECT_NEAR(display.pixel_aspect({800, 600}), 1.0, 1e-12);
        EXPECT_NEAR(display.pixel_aspect({1600, 600}), 0.5, 1e-12);
    }
    EXPECT_EQ(make({}).pixel_aspect({1600, 600}), 1.0);
}

TEST_F(DisplayWall, ShowsTheSameInstantsOnAllTiles) {
    const auto file = write(tile("left", -2.0, 0.0));
    const Display display = make({.wall = file, .tile = "left", .delay_ms = 100.0});
    const Timestamp now{1'700'000'000'000'000'000};
    std::int64_t before = 0;
    for (int i = 0; i < 100; ++i) {
        const Timestamp at = now + std::chrono::milliseconds(7 * i);
        const auto shown = display.instant(at);
        ASSERT_TRUE(shown);
        EXPECT_GE((at - *shown).count(), 100'000'000);
        EXPECT_LE((at - *shown).count(), 100'000'000 + 16'666'667);
        EXPECT_GE(shown->ns, before);
        before = shown->ns;
        // the instant is the same for every program that asks within the same sixtieth of a second
        const auto left_ns = 16'666'665 - (at - *shown).count() + 100'000'000;
        EXPECT_EQ(display.instant(at + std::chrono::nanoseconds(std::max(left_ns, 0L))), shown);
    }
}

TEST_F(DisplayWall, IsRefusedWithAReason) {
    EXPECT_NE(refused(tile("left", -1, 1), "middle").find("one of left"), std::string::npos);
    EXPECT_NE(refused("[wall]\n").find("tile"), std::string::npos);
    EXPECT_NE(
        refused(tile("left", -1, 1) + tile("left", 1, 2)).find("must differ from the other tiles"),
        std::string::npos);
    EXPECT_NE(refused(tile("left", 1, -1)).find("to the right"), std::string::npos);
    EXPECT_NE(refused(tile("left", 1, 1)).find("1 cm"), std::string::npos);
    EXPECT_NE(
        refused("[wall]\neye_m = [0, 1, 1.6]\n" + tile("left", -1, 1)).find("before the tile"),
        std::string::npos);
    EXPECT_NE(refused("[[tile]]\nname = \"left\"\nlower_left_m = [0, 0, 0]\nlower_right_m = [1, 0, "
                      "0]\nupper_left_m = [1, 0, 1]\n")
                  .find("right angle"),
              std::string::npos);
    EXPECT_NE(refused("[wall]\nyaw = 3\n" + tile("left", -1, 1)).find("yaw"), std::string::npos);
    const auto alone = Display::create({.tile = "left"});
    ASSERT_FALSE(alone);
    EXPECT_NE(alone.error().message.find("needs display.wall"), std::string::npos);
    EXPECT_FALSE(Display::create({.wall = "no/such.toml", .tile = "left"}));
}

TEST_F(DisplayWall, AcceptsTheDeliveredFile) {
    for (const char* tile : {"left", "right"})
        EXPECT_TRUE(Display::create(
            {.wall = atrium::test::source_dir() + "/deploy/walls/two_projectors.toml",
             .tile = tile}));
}

}  // namespace
}  // namespace atrium::viewer
