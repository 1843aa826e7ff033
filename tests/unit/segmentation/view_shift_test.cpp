#include "site_node/segmentation/view_shift.hpp"

#include "site_node/segmentation/room_watch.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace atrium::segmentation {
namespace {

constexpr int kWallWidth = 640;
constexpr int kWallHeight = 480;

// A wall with blotches of three sizes, seen anywhere.
class Wall {
public:
    explicit Wall(std::uint32_t seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> value(-1.0, 1.0);
        for (auto& layer : values_)
            for (double& v : layer) v = value(random);
    }

    double at(double x, double y) const {
        return 120.0 + 24.0 * layer(0, x / 60.0, y / 60.0) + 18.0 * layer(1, x / 21.0, y / 21.0) +
               10.0 * layer(2, x / 8.0, y / 8.0);
    }

private:
    static constexpr int kSide = 64;

    double layer(std::size_t which, double x, double y) const {
        const double x0 = std::floor(x);
        const double y0 = std::floor(y);
        const auto value = [&](double i, double j) {
            const auto wrap = [](double v) { return static_cast<std::size_t>(v) & (kSide - 1); };
            return values_[which][wrap(j + 4096.0) * kSide + wrap(i + 4096.0)];
        };
        const double u = x - x0;
        const double v = y - y0;
        return (1 - v) * ((1 - u) * value(x0, y0) + u * value(x0 + 1, y0)) +
               v * ((1 - u) * value(x0, y0 + 1) + u * value(x0 + 1, y0 + 1));
    }

    std::array<std::array<double, kSide * kSide>, 3> values_{};
};

struct Shown {
    Eigen::Vector2d shift_px{0.0, 0.0};  // of the room in the picture
    double roll_rad = 0.0;
    double light = 1.0;
    double hidden = 0.0;  // share of the width that somebody hides
};

image::Plane wall_picture(const Wall& wall, const Shown& shown, std::mt19937& random) {
    std::normal_distribution<double> noise(0.0, 2.0);
    image::Plane plane(kWallWidth, kWallHeight);
    const Eigen::Rotation2Dd turn(shown.roll_rad);
    const Eigen::Vector2d middle(0.5 * kWallWidth, 0.5 * kWallHeight);
    for (int y = 0; y < kWallHeight; ++y) {
        for (int x = 0; x < kWallWidth; ++x) {
            const Eigen::Vector2d p =
                turn * (Eigen::Vector2d(x, y) - shown.shift_px - middle) + middle;
            const bool is_hidden = x > 0.3 * kWallWidth && x < (0.3 + shown.hidden) * kWallWidth;
            const double luma = is_hidden ? 60.0 + 0.2 * x : shown.light * wall.at(p.x(), p.y());
            plane.row(y)[x] =
                static_cast<std::uint8_t>(std::clamp(luma + noise(random), 0.0, 255.0));
        }
    }
    return plane;
}

std::vector<std::uint16_t> learned_from(const image::Plane& picture) {
    std::vector<std::uint16_t> luma;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            luma.push_back(static_cast<std::uint16_t>(256 * picture.at(x, y)));
    return luma;
}

TEST(ViewShift, IsFoundWhateverTheLightAndSomebodyInFront) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> angle(0.0, 6.28);
    ViewScratch scratch;
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
        const Wall wall(seed);
        const auto room = learned_from(wall_picture(wall, {}, random));
        for (const double length_px : {3.5, 5.0, 9.0, 14.0, 30.0, 60.0}) {
            const double at = angle(random);
            Shown shown;
            shown.shift_px = length_px * Eigen::Vector2d(std::cos(at), std::sin(at));
            shown.roll_rad = seed % 2 == 0 ? 0.004 : 0.0;
            shown.light = 0.8 + 0.07 * seed;
            shown.hidden = seed % 3 == 0 ? 0.3 : 0.0;
            const image::Plane picture = wall_picture(wall, shown, random);
            const auto found = find_view_shift(room, picture, scratch);
            ASSERT_TRUE(found) << seed << ", " << length_px << " px";
            EXPECT_LT((*found - shown.shift_px).norm(), shown.hidden > 0.0 ? 1.5 : 0.7)
                << seed << ", " << length_px;
        }
    }
}

TEST(ViewShift, IsNoneOfTheSameViewAnotherRoomOrAPlainOne) {
    std::mt19937 random(6);
    ViewScratch scratch;
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
        const Wall wall(seed);
        const auto room = learned_from(wall_picture(wall, {}, random));
        for (const double hidden : {0.0, 0.35, 0.7}) {
            Shown shown;
            shown.light = 0.7 + 0.08 * seed;
            shown.hidden = hidden;
            shown.shift_px = {0.3, -0.4};
            const image::Plane picture = wall_picture(wall, shown, random);
            EXPECT_EQ(find_view_shift(room, picture, scratch), std::nullopt)
                << seed << ", " << hidden;
        }
        const image::Plane other = wall_picture(Wall(seed + 100), {}, random);
        EXPECT_EQ(find_view_shift(room, other, scratch), std::nullopt) << seed;
        Shown far;
        far.shift_px = {150.0, 40.0};
        const image::Plane beyond = wall_picture(wall, far, random);
        EXPECT_EQ(find_view_shift(room, beyond, scratch), std::nullopt) << seed;
    }
    const image::Plane plain(kWallWidth, kWallHeight);
    EXPECT_EQ(find_view_shift(learned_from(plain), plain, scratch), std::nullopt);
    const image::Plane small(64, 48);
    EXPECT_EQ(find_view_shift(learned_from(plain), small, scratch), std::nullopt);
    EXPECT_EQ(find_view_shift(learned_from(small), small, scratch), std::nullopt);
}

// One look says nothing: the picture may have been taken while somebody bumped the camera's stand.
TEST(RoomWatchOfView, HoldsAShiftFromSeveralLooksUntilAsManyFindNone) {
    std::mt19937 random(7);
    const Wall wall(3);
    const auto room = learned_from(wall_picture(wall, {}, random));
    const auto look = [&](RoomWatch& watch, double shift_px) {
        Shown shown;
        shown.shift_px.x() = shift_px;
        const image::Plane luma = wall_picture(wall, shown, random);
        image::YuvView picture;
        picture.y = luma;
        watch.look_at_view(picture, room);
        return watch.view_shift() ? watch.view_shift()->x() : 0.0;
    };
    RoomWatch watch;
    EXPECT_EQ(look(watch, 0.0), 0.0);
    EXPECT_EQ(look(watch, 14.0), 0.0);
    EXPECT_EQ(look(watch, 0.0), 0.0);
    EXPECT_EQ(look(watch, 14.0), 0.0);
    EXPECT_EQ(look(watch, 25.0), 0.0) << "it still moves";
    EXPECT_NEAR(look(watch, 25.0), 25.0, 1.0);
    EXPECT_NEAR(look(watch, 0.0), 25.0, 1.0);
    EXPECT_EQ(look(watch, 0.0), 0.0);
    std::uint32_t num_due = 0;
    for (std::uint32_t i = 0; i < RoomWatch::kFirstGap + 3 * RoomWatch::kViewGap; ++i)
        num_due += watch.is_view_due() ? 1 : 0;
    EXPECT_EQ(num_due, 4U);
}

}  // namespace
}  // namespace atrium::segmentation
