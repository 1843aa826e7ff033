#include "viewer/renderer/person/gain_compensation.hpp"

#include "tests/unit/renderer/synthetic_person.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace atrium::renderer {
namespace {

using synthetic::Sphere;
using Factors = std::array<Eigen::Array3d, 8>;  // per camera, of red, green and blue

const Sphere kSphere{{0.0, 0.0, 1.0}, 0.5};

Eigen::Vector3d painted(const Eigen::Vector3d& p) {
    return {0.45 + 0.15 * std::sin(9.0 * p.x()),
            0.40 + 0.15 * std::sin(7.0 * p.y() + 1.0),
            0.50 + 0.15 * std::sin(8.0 * p.z())};
}

Factors made_up() {
    constexpr std::array<double, 8> kGains = {0.8, 1.1, 0.9, 1.2, 1.0, 0.85, 1.15, 0.95};
    Factors factors;
    for (std::size_t i = 0; i < factors.size(); ++i)
        factors[i] = {kGains[i], kGains[(i + 3) % 8], kGains[(i + 6) % 8]};
    return factors;
}

struct Built {
    PersonModel model;
    std::vector<Eigen::Array3d> log_gains;
};

Built build(const Factors& factors, const GainCompensationOptions& options) {
    const auto cameras = synthetic::ring(8, kSphere.centre);
    std::vector<CameraPicture> pictures;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        pictures.push_back(synthetic::picture_of({kSphere}, cameras[i], [&](const auto& p) {
            return Eigen::Vector3d((painted(p).array() * factors[i]).min(1.0));
        }));
    }
    Built built;
    PersonModelScratch scratch;
    PersonModelOptions model_options;
    model_options.gain_compensation = options;
    build_person_model(
        synthetic::mesh_of({kSphere}, 24), pictures, model_options, scratch, built.model);
    built.log_gains = scratch.gain_compensation.log_gains;
    return built;
}

// Mean over the vertices of the largest difference between two cameras there, in grey levels. It is
// visible where one camera takes over from another.
double seam_contrast(const PersonModel& model) {
    double sum = 0.0;
    int num = 0;
    for (std::size_t v = 0; v < model.vertices_site.size(); ++v) {
        Eigen::Array3d low = Eigen::Array3d::Constant(255.0);
        Eigen::Array3d high = Eigen::Array3d::Zero();
        for (std::size_t c = 0; c < model.cameras.size(); ++c) {
            if (model.cameras[c].quality[v] < 0.99f) continue;
            const Eigen::Vector3f& st = model.cameras[c].layer_coordinates[v];
            const auto x =
                static_cast<std::size_t>(st.x() / st.z() * static_cast<float>(model.layer_width));
            const auto y =
                static_cast<std::size_t>(st.y() / st.z() * static_cast<float>(model.layer_height));
            const auto width = static_cast<std::size_t>(model.layer_width);
            const auto height = static_cast<std::size_t>(model.layer_height);
            const std::uint8_t* rgba =
                model.layers.data() + 4 * (c * width * height + y * width + x);
            if (rgba[3] != 255) continue;
            low = low.min(Eigen::Array3d(rgba[0], rgba[1], rgba[2]));
            high = high.max(Eigen::Array3d(rgba[0], rgba[1], rgba[2]));
        }
        if (high.maxCoeff() == 0.0) continue;
        sum += (high - low).maxCoeff();
        ++num;
    }
    EXPECT_GT(num, 500);
    return sum / num;
}

TEST(GainCompensation, RemovesSeamsBetweenCamerasOfDifferentColours) {
    Factors equal;
    equal.fill(Eigen::Array3d::Ones());
    const double least = seam_contrast(build(equal, {.max_points = 0}).model);
    const double before = seam_contrast(build(made_up(), {.max_points = 0}).model);
    const double after = seam_contrast(build(made_up(), {}).model);
    EXPECT_GT(before, least + 15.0);
    // the rest is the sampling, and 1 % of a colour that is not corrected
    EXPECT_LT(after, least + 3.0);
}

TEST(GainCompensation, FindsTheFactorsOfTheCameras) {
    const Factors factors = made_up();
    const Built built = build(factors, {});
    ASSERT_EQ(built.log_gains.size(), factors.size());
    Eigen::Array3d mean = Eigen::Array3d::Zero();
    for (const Eigen::Array3d& own : factors) mean += own.log() / 8.0;
    for (std::size_t c = 0; c < factors.size(); ++c) {
        // up to a common factor, which the cameras cannot show, and the dead zone
        const Eigen::Array3d left = built.log_gains[c] + factors[c].log() - mean;
        EXPECT_LT(left.abs().maxCoeff(), 0.025) << c << ": " << left.transpose();
    }
}

TEST(GainCompensation, DoesNotChangeCamerasThatAgree) {
    Factors equal;
    equal.fill(Eigen::Array3d::Ones());
    const Built evened = build(equal, {});
    EXPECT_EQ(evened.model.layers, build(equal, {.max_points = 0}).model.layers);
    for (const Eigen::Array3d& log_gain : evened.log_gains)
        EXPECT_EQ(log_gain.abs().maxCoeff(), 0.0);
}

TEST(GainCompensation, KeepsThePersonsMeanColour) {
    const Built built = build(made_up(), {});
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    for (const Eigen::Array3d& log_gain : built.log_gains) sum += log_gain;
    EXPECT_LT(sum.abs().maxCoeff(), 0.04);  // four dead zones
}

TEST(GainCompensation, DoesNotChangeACameraWithoutSharedVertices) {
    const auto camera = synthetic::camera_at({3.0, 0.0, 1.0}, kSphere.centre);
    const auto opposite = synthetic::camera_at({-3.0, 0.0, 1.0}, kSphere.centre);
    const auto green = [](const auto&) { return Eigen::Vector3d(0.2, 0.7, 0.3); };
    const auto red = [](const auto&) { return Eigen::Vector3d(0.7, 0.2, 0.3); };
    PersonModelScratch scratch;
    PersonModel model;
    build_person_model(synthetic::mesh_of({kSphere}, 24),
                       std::vector{synthetic::picture_of({kSphere}, camera, green),
                                   synthetic::picture_of({kSphere}, opposite, red)},
                       {},
                       scratch,
                       model);
    for (const Eigen::Array3d& log_gain : scratch.gain_compensation.log_gains)
        EXPECT_EQ(log_gain.abs().maxCoeff(), 0.0);
}

}  // namespace
}  // namespace atrium::renderer
