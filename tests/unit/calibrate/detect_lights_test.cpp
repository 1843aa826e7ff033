// Lights in rendered pictures, whose true centres are known.
#include "tools/calibrate/sweep/detect_lights.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace atrium::calibrate {
namespace {

using Eigen::Vector2d;

// What a sensor would deliver: light is added up, then rounded and limited.
class Exposure {
public:
    Exposure(int width, int height, double background)
        : width_(width),
          height_(height),
          light_(static_cast<std::size_t>(width * height), background) {}

    double& at(int x, int y) { return light_[static_cast<std::size_t>(y * width_ + x)]; }

    // A spot that moves by `motion` during the exposure, and is at `centre` in the middle of it.
    void add_spot(const Vector2d& centre,
                  double sigma_px,
                  double contrast,
                  const Vector2d& motion = Vector2d::Zero()) {
        const int num_steps = 1 + static_cast<int>(4.0 * motion.norm() / sigma_px);
        const double reach = 5.0 * sigma_px + 0.5 * motion.norm();
        for (int y = std::max(0, static_cast<int>(centre.y() - reach));
             y <= std::min<double>(height_ - 1, centre.y() + reach);
             ++y) {
            for (int x = std::max(0, static_cast<int>(centre.x() - reach));
                 x <= std::min<double>(width_ - 1, centre.x() + reach);
                 ++x) {
                for (int k = 0; k < num_steps; ++k) {
                    const Vector2d now = centre + ((k + 0.5) / num_steps - 0.5) * motion;
                    at(x, y) += contrast / num_steps *
                                std::exp(-0.5 * (Vector2d(x, y) - now).squaredNorm() /
                                         (sigma_px * sigma_px));
                }
            }
        }
    }

    image::Plane read(double noise, std::uint32_t seed) const {
        std::mt19937 rng(seed);
        std::normal_distribution<double> normal(0.0, 1.0);
        image::Plane plane(width_, height_);
        for (std::size_t i = 0; i < light_.size(); ++i)
            plane.data[i] = static_cast<std::uint8_t>(
                std::clamp(std::round(light_[i] + noise * normal(rng)), 0.0, 255.0));
        return plane;
    }

private:
    int width_, height_;
    std::vector<double> light_;
};

DetectedLights detect(const image::Plane& plane,
                      image::Mosaic mosaic = image::Mosaic::kNone,
                      double threshold = 0.0) {
    image::YuvView view;
    view.y = plane;
    view.mosaic = mosaic;
    LightDetector detector({threshold});
    DetectedLights found;
    detector.detect(view, found);
    return found;
}

double distance_to_nearest(const DetectedLights& found, const Vector2d& px) {
    double least = 1e9;
    for (const DetectedLight& light : found.lights) least = std::min(least, (light.px - px).norm());
    return least;
}

struct Scene {
    const char* name;
    double sigma_low, sigma_high;        // of the spots [px]
    double contrast_low, contrast_high;  // above 245 they saturate
    double motion_px;                    // most
};

class SpotsOf : public testing::TestWithParam<Scene> {};

// 48 spots at any place of a grid, on a slope of light, with noise of 2 levels.
TEST_P(SpotsOf, HaveCentresGoodToATenthOfAPixel) {
    const Scene& scene = GetParam();
    std::mt19937 rng(7);
    std::uniform_real_distribution<double> any(0.0, 1.0);
    double sum = 0.0, most = 0.0;
    int num = 0;
    for (std::uint32_t round = 0; round < 5; ++round) {
        Exposure exposure(640, 480, 10.0);
        for (int y = 0; y < 480; ++y)
            for (int x = 0; x < 640; ++x) exposure.at(x, y) += 0.01 * x;
        std::vector<Vector2d> truth;
        for (int row = 0; row < 6; ++row) {
            for (int column = 0; column < 8; ++column) {
                truth.emplace_back(40.0 + 80.0 * column + 9.0 * any(rng),
                                   40.0 + 80.0 * row + 9.0 * any(rng));
                const double angle = 6.28 * any(rng);
                const double motion = scene.motion_px * any(rng);
                const double sigma =
                    scene.sigma_low + (scene.sigma_high - scene.sigma_low) * any(rng);
                const double contrast =
                    scene.contrast_low + (scene.contrast_high - scene.contrast_low) * any(rng);
                exposure.add_spot(truth.back(),
                                  sigma,
                                  contrast,
                                  motion * Vector2d(std::cos(angle), std::sin(angle)));
            }
        }
        const DetectedLights found = detect(exposure.read(2.0, round));
        EXPECT_EQ(found.lights.size(), truth.size());
        for (const Vector2d& px : truth) {
            const double off = distance_to_nearest(found, px);
            sum += off * off;
            most = std::max(most, off);
            ++num;
        }
    }
    EXPECT_LT(std::sqrt(sum / (2.0 * num)), 0.1) << "RMS per coordinate";
    EXPECT_LT(most, 0.5);
    RecordProperty("rms_px", std::to_string(std::sqrt(sum / (2.0 * num))));
    RecordProperty("most_px", std::to_string(most));
}
INSTANTIATE_TEST_SUITE_P(Kinds,
                         SpotsOf,
                         testing::Values(Scene{"Small", 0.8, 1.2, 60, 240, 0},
                                         Scene{"Large", 2.0, 3.0, 60, 240, 0},
                                         Scene{"Saturated", 1.2, 2.2, 300, 700, 0},
                                         Scene{"Moving", 1.2, 1.8, 150, 400, 25},
                                         Scene{"Dim", 1.2, 2.0, 30, 60, 0}),
                         [](const auto& scene) { return std::string(scene.param.name); });

TEST(DetectLights, LeavesOutWhatIsNoLight) {
    Exposure exposure(640, 480, 12.0);
    const Vector2d light(320.3, 240.6);
    exposure.add_spot(light, 1.5, 200.0);
    for (int y = 20; y < 160; ++y)  // a window
        for (int x = 30; x < 230; ++x) exposure.at(x, y) = 250.0;
    exposure.add_spot({500.0, 100.0}, 14.0, 400.0);               // a lamp
    for (int x = 300; x < 420; ++x) exposure.at(x, 400) = 180.0;  // an edge of metal
    exposure.add_spot({0.4, 300.0}, 2.0, 200.0);                  // cut by the border
    exposure.add_spot({639.0, 330.0}, 2.0, 200.0);
    std::mt19937 rng(2);
    for (int i = 0; i < 50; ++i)
        exposure.at(static_cast<int>(rng() % 640), 170 + static_cast<int>(rng() % 50)) = 255.0;
    const DetectedLights found = detect(exposure.read(2.0, 3));
    ASSERT_EQ(found.lights.size(), 1U);
    EXPECT_LT((found.lights[0].px - light).norm(), 0.1);
    EXPECT_GE(found.num_large, 3U);
    EXPECT_GE(found.num_specks, 40U);
    EXPECT_NEAR(found.background, 12.0, 1.0);
    EXPECT_NEAR(found.noise, 2.0, 0.3);
}

TEST(DetectLights, FindsNothingInNoise) {
    for (const double noise : {0.0, 0.3, 1.0, 3.0, 8.0}) {
        for (const double background : {0.0, 12.0, 120.0, 250.0}) {
            const DetectedLights found = detect(Exposure(640, 480, background).read(noise, 11));
            EXPECT_TRUE(found.lights.empty()) << noise << " " << background;
        }
    }
}

TEST(DetectLights, TellsLightsApartWhoseHalosTouch) {
    Exposure exposure(200, 200, 10.0);
    const Vector2d a(90.2, 100.7), b(99.1, 103.4);
    exposure.add_spot(a, 1.8, 180.0);
    exposure.add_spot(b, 1.8, 150.0);
    const DetectedLights found = detect(exposure.read(1.5, 5));
    ASSERT_EQ(found.lights.size(), 2U);
    EXPECT_LT(distance_to_nearest(found, a), 0.3);
    EXPECT_LT(distance_to_nearest(found, b), 0.3);
}

TEST(DetectLights, TakesAThresholdOfTheUser) {
    Exposure exposure(320, 240, 10.0);
    exposure.add_spot({100.0, 100.0}, 1.5, 200.0);
    exposure.add_spot({200.0, 100.0}, 1.5, 15.0);  // less than a tenth
    EXPECT_EQ(detect(exposure.read(0.5, 5)).lights.size(), 1U);
    EXPECT_EQ(detect(exposure.read(0.5, 5), image::Mosaic::kNone, 8.0).lights.size(), 2U);
    EXPECT_EQ(detect(exposure.read(0.5, 5), image::Mosaic::kNone, 230.0).lights.size(), 0U);
}

TEST(DetectLights, AreFoundInAMosaic) {
    std::mt19937 rng(4);
    std::uniform_real_distribution<double> any(0.0, 1.0);
    for (const bool is_red : {false, true}) {
        double sum = 0.0;
        int num = 0;
        for (std::uint32_t i = 0; i < 40; ++i) {
            Exposure exposure(64, 64, 10.0);
            const Vector2d truth(28.0 + 6.0 * any(rng), 28.0 + 6.0 * any(rng));
            exposure.add_spot(truth, 1.6, 200.0);
            if (is_red)
                for (int y = 0; y < 64; ++y)
                    for (int x = 0; x < 64; ++x)
                        if (((x | y) & 1) != 0) exposure.at(x, y) = 10.0;
            const DetectedLights found = detect(exposure.read(1.0, i), image::Mosaic::kRG);
            ASSERT_EQ(found.lights.size(), 1U) << is_red << " " << truth.transpose();
            sum += (found.lights[0].px - truth).squaredNorm();
            ++num;
        }
        EXPECT_LT(std::sqrt(sum / (2.0 * num)), 0.1) << is_red;
    }
}

TEST(DetectLights, SurvivesAnyPicture) {
    std::mt19937 rng(6);
    for (const auto& [width, height] :
         {std::pair{1, 1}, {2, 2}, {3, 40}, {15, 9}, {16, 16}, {17, 33}, {200, 150}}) {
        for (int kind = 0; kind < 4; ++kind) {
            image::Plane plane(width, height, kind == 0 ? 0 : 255);
            if (kind >= 2)
                for (std::uint8_t& pixel : plane.data)
                    pixel = static_cast<std::uint8_t>(kind == 2 ? rng() : (rng() % 40 == 0) * 255);
            for (const auto mosaic : {image::Mosaic::kNone, image::Mosaic::kGB}) {
                const DetectedLights found = detect(plane, mosaic);
                EXPECT_LE(found.lights.size(), kMostLights);
                for (const DetectedLight& light : found.lights) {
                    EXPECT_GE(light.px.minCoeff(), 0.0);
                    EXPECT_LE(light.px.x(), width);
                    EXPECT_LE(light.px.y(), height);
                }
            }
        }
    }
}

TEST(DetectLights, GivesTheSameAfterOtherPictures) {
    Exposure exposure(320, 240, 10.0);
    exposure.add_spot({100.3, 120.9}, 1.5, 200.0);
    const image::Plane plane = exposure.read(2.0, 1);
    const image::Plane bright(320, 240, 255);
    LightDetector detector({});
    DetectedLights first, other, again;
    image::YuvView view;
    view.y = plane;
    detector.detect(view, first);
    image::YuvView second;
    second.y = bright;
    detector.detect(second, other);
    detector.detect(view, again);
    ASSERT_EQ(first.lights.size(), 1U);
    ASSERT_EQ(again.lights.size(), 1U);
    EXPECT_EQ(first.lights[0].px, again.lights[0].px);
}

}  // namespace
}  // namespace atrium::calibrate
