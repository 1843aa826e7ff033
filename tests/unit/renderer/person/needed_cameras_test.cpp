#include "viewer/renderer/person/needed_cameras.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace atrium::renderer {
namespace {

const Eigen::AlignedBox3f kPerson(Eigen::Vector3f(-0.3F, -0.3F, 0.0F),
                                  Eigen::Vector3f(0.3F, 0.3F, 1.8F));

Eigen::Vector3f around(float deg, float radius_m) {
    const float rad = deg * std::numbers::pi_v<float> / 180.0F;
    return {radius_m * std::cos(rad), radius_m * std::sin(rad), 1.2F};
}

std::vector<Eigen::Vector3f> ring(int num) {
    std::vector<Eigen::Vector3f> centres;
    for (int i = 0; i < num; ++i)
        centres.push_back(around(360.0F * static_cast<float>(i) / static_cast<float>(num), 3.0F));
    return centres;
}

TEST(NeededCameras, AreOnTheEyesSide) {
    const std::vector<Eigen::Vector3f> eyes = {around(0.0F, 4.0F)};
    const auto needed = needed_cameras(ring(8), kPerson, eyes, {.max_angle_deg = 110.0});
    const std::vector<bool> expected = {true, true, true, false, false, false, true, true};
    EXPECT_EQ(needed, expected);
}

TEST(NeededCameras, OfSeveralEyesAreTheUnion) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> angle(0.0F, 360.0F);
    for (int round = 0; round < 100; ++round) {
        const auto centres = ring(12);
        const std::vector<Eigen::Vector3f> eyes = {around(angle(random), 4.0F),
                                                   around(angle(random), 2.0F)};
        const auto both = needed_cameras(centres, kPerson, eyes);
        const auto first = needed_cameras(centres, kPerson, {&eyes[0], 1});
        const auto second = needed_cameras(centres, kPerson, {&eyes[1], 1});
        for (std::size_t c = 0; c < centres.size(); ++c)
            EXPECT_EQ(both[c], first[c] || second[c]) << round << ", " << c;
        EXPECT_LT(std::ranges::count(first, true), 12);
    }
}

TEST(NeededCameras, AreAllWithoutAnEyeOrAPersonOrWithTheEyeInside) {
    const std::vector<bool> all(8, true);
    const std::vector<Eigen::Vector3f> outside = {around(0.0F, 4.0F)};
    const std::vector<Eigen::Vector3f> inside = {Eigen::Vector3f(0.1F, 0.0F, 1.6F)};
    EXPECT_EQ(needed_cameras(ring(8), kPerson, {}), all);
    EXPECT_EQ(needed_cameras(ring(8), {}, outside), all);
    EXPECT_EQ(needed_cameras(ring(8), kPerson, inside), all);
    EXPECT_TRUE(needed_cameras({}, kPerson, outside).empty());
}

TEST(NeededCameras, AreTheNearestIfAllAreFar) {
    // all behind the person
    std::vector<Eigen::Vector3f> centres;
    for (const float deg : {150.0F, 165.0F, 190.0F, 175.0F, 160.0F, 215.0F})
        centres.push_back(around(deg, 3.0F));
    const std::vector<Eigen::Vector3f> eyes = {around(0.0F, 4.0F)};
    const auto needed = needed_cameras(centres, kPerson, eyes, {.least_num = 4});
    const std::vector<bool> expected = {true, true, false, false, true, true};
    EXPECT_EQ(needed, expected);
    EXPECT_EQ(needed_cameras(ring(3), kPerson, eyes), std::vector<bool>(3, true));
}

}  // namespace
}  // namespace atrium::renderer
