#include "viewer/renderer/person/outline_strip.hpp"

#include "tests/support/pictures/person_photographer.hpp"
#include "tests/unit/renderer/synthetic_person.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

namespace atrium::renderer {
namespace {

using synthetic::Sphere;

const Eigen::Vector3d kPaint(0.2, 0.7, 0.3);
const Eigen::Vector3d kMiddle(0.0, 0.0, 1.0);
constexpr double kRadius_m = 0.5;
constexpr double kShrunk_m = 0.008;  // 1.3 px of the cameras
constexpr int kNumCameras = 8;
// All of the strip, in place.
constexpr OutlineStripOptions kWhole{
    .end_texels = 1e4F, .most_cosine = 1e4F, .behind_m = 0.0F, .part_m = 0.0F};

// The model of a person whose hull is `hull`, filmed by a ring of cameras that saw `true_shape`.
PersonModel model_of(const std::vector<Sphere>& hull, const std::vector<Sphere>& true_shape) {
    std::vector<CameraPicture> pictures;
    for (const auto& camera : synthetic::ring(kNumCameras, kMiddle))
        pictures.push_back(
            synthetic::picture_of(true_shape, camera, [](const auto&) { return kPaint; }));
    PersonModelScratch scratch;
    PersonModel model;
    build_person_model(synthetic::mesh_of(hull, 40), pictures, {}, scratch, model);
    return model;
}

PersonModel sphere_model(double hull_radius_m) {
    return model_of({{kMiddle, hull_radius_m}}, {{kMiddle, kRadius_m}});
}

struct Corner {
    Eigen::Vector3f position;
    std::array<std::size_t, kStripCameras> cameras;
    std::array<Eigen::Vector3f, kStripCameras> in_layers;
    std::array<float, kStripCameras> weights;
};

// Inner and outer corner of the first end of each quadrilateral, then of the second.
std::vector<std::array<Corner, 4>> quads_of(const PersonModel& model,
                                            const Eigen::Vector3f& eye,
                                            const OutlineStripOptions& options) {
    BlendScratch scratch;
    BlendedMesh blended;
    blend_for_view(model, eye, scratch, blended);
    OutlineStrip strip;
    strip.find(model, eye, scratch, options);
    constexpr std::size_t kFloats = floats_per_vertex(kStripCameras);
    EXPECT_EQ(strip.vertices().size() % (6 * kFloats), 0u);
    std::vector<std::array<Corner, 4>> quads(strip.num_vertices() / 6);
    for (std::size_t q = 0; q < quads.size(); ++q) {
        constexpr std::array<std::size_t, 4> kPlaces{0, 1, 2, 5};
        for (std::size_t i = 0; i < 4; ++i) {
            const float* from = strip.vertices().data() + (6 * q + kPlaces[i]) * kFloats;
            Corner& corner = quads[q][i];
            corner.position = Eigen::Vector3f(from);
            for (std::size_t k = 0; k < kStripCameras; ++k) {
                corner.cameras[k] = static_cast<std::size_t>(from[6 + k]);
                const float* picture = from + 6 + kStripCameras + 4 * k;
                corner.in_layers[k] = Eigen::Vector3f(picture);
                corner.weights[k] = picture[3];
            }
        }
    }
    return quads;
}

TEST(OutlineStrip, FollowsTheOutlineOnce) {
    const PersonModel model = sphere_model(kRadius_m);
    const Eigen::Vector3f eye(2.4F, 1.1F, 1.8F);
    const Eigen::Vector3f centre = kMiddle.cast<float>();
    const auto quads = quads_of(model, eye, kWhole);
    ASSERT_GT(quads.size(), 60u);
    std::map<std::array<float, 3>, int> ends;
    for (const auto& quad : quads) {
        for (const std::size_t end : {0U, 2U}) {
            const Eigen::Vector3f& inner = quad[end].position;
            const Eigen::Vector3f outwards = quad[end + 1].position - inner;
            const Eigen::Vector3f normal = (inner - centre).normalized();
            EXPECT_NEAR(normal.dot((eye - inner).normalized()), 0.0F, 0.02F);
            EXPECT_GT(normal.dot(outwards.normalized()), 0.999F);
            // two texels of two pixels
            const float depth =
                (model.cameras[quad[end].cameras[0]].camera_from_site * inner.cast<double>())
                    .cast<float>()
                    .z();
            EXPECT_NEAR(outwards.norm(), 4.0F * depth / 500.0F, 1e-4F);
            ++ends[{inner.x(), inner.y(), inner.z()}];
        }
    }
    for (const auto& [place, num] : ends)
        EXPECT_EQ(num, 2) << "the strip has no gap " << place[0] << " " << place[1] << " "
                          << place[2];
}

TEST(OutlineStrip, EachCornerIsWhereItsCamerasSeeIt) {
    const PersonModel model = sphere_model(kRadius_m);
    for (const auto& quad : quads_of(model, {1.0F, -2.2F, 0.6F}, kWhole)) {
        for (const Corner& corner : quad) {
            float sum = 0.0F;
            for (std::size_t k = 0; k < kStripCameras; ++k) {
                sum += corner.weights[k];
                ASSERT_GE(corner.weights[k], 0.0F);
                const PersonModel::Camera& camera = model.cameras[corner.cameras[k]];
                const Eigen::Vector3d at = camera.camera_from_site * corner.position.cast<double>();
                EXPECT_NEAR(corner.in_layers[k].z(), at.z(), 1e-4);
                const Eigen::Vector2d px = camera.intrinsics.project(at);
                const Eigen::Array2d share =
                    (px.array() - Eigen::Array2d(camera.crop_px.x - 0.5, camera.crop_px.y - 0.5)) /
                    Eigen::Array2d(camera.crop_px.width, camera.crop_px.height);
                const Eigen::Array2d st =
                    camera.low_st.cast<double>().array() +
                    share * (camera.high_st - camera.low_st).cast<double>().array();
                const Eigen::Array2d found = corner.in_layers[k].head<2>().cast<double>() / at.z();
                EXPECT_LT((found - st).abs().maxCoeff() * model.layer_width, 0.02);
            }
            EXPECT_NEAR(sum, 1.0F, 0.05F);
        }
    }
}

TEST(OutlineStrip, AtItsPlaceOneCameraDecides) {
    const PersonModel model = sphere_model(kRadius_m);
    for (std::size_t c = 0; c < model.cameras.size(); ++c) {
        for (const auto& quad : quads_of(model, model.cameras[c].centre_site, {})) {
            EXPECT_EQ(quad[0].cameras[0], c);
            EXPECT_GT(quad[0].weights[0], 0.97F);
        }
    }
}

TEST(OutlineStrip, NobodyHasNone) {
    PersonModel nobody;
    EXPECT_TRUE(quads_of(nobody, {1.0F, 2.0F, 1.0F}, kWhole).empty());
    PersonModel unseen = sphere_model(kRadius_m);
    unseen.cameras.clear();
    EXPECT_TRUE(quads_of(unseen, {1.0F, 2.0F, 1.0F}, kWhole).empty());
}

// What a camera would see of the spheres, pixel by pixel.
image::Mask true_mask(const std::vector<Sphere>& spheres, const geometry::CalibratedCamera& from) {
    image::Mask mask(from.intrinsics.width, from.intrinsics.height);
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            const Eigen::Vector2d px(x, y);
            const Eigen::Vector3d ray((px.x() - from.intrinsics.cx) / from.intrinsics.fx,
                                      (px.y() - from.intrinsics.cy) / from.intrinsics.fy,
                                      1.0);
            Eigen::Vector3d p;
            const Eigen::Vector3d direction =
                (from.camera_from_site.rotation.conjugate() * ray).normalized();
            if (synthetic::hit(spheres, from.centre_site(), direction, p)) mask.row(y)[x] = 255;
        }
    }
    return mask;
}

struct Shares {
    double bare = 0.0;     // of the mask, not covered
    double far_off = 0.0;  // covered, more than kFarOff_px outside the mask
    double wrong = 0.0;    // of the mask: covered in another colour
};

// The textures' pixels are two of the mask's wide, and show the person if half of them does.
constexpr double kFarOff_px = 2.5;

bool is_far_off(const image::Mask& mask, int x, int y) {
    for (int dy = -3; dy <= 3; ++dy) {
        for (int dx = -3; dx <= 3; ++dx) {
            if (std::hypot(dx, dy) <= kFarOff_px && mask.at(x + dx, y + dy) != 0) return false;
        }
    }
    return true;
}

Shares shares_of(const test::Photo& photo, const image::Mask& mask) {
    Shares shares;
    double num = 0.0;
    for (int y = 3; y + 3 < mask.height; ++y) {
        for (int x = 3; x + 3 < mask.width; ++x) {
            const double opacity = photo.opacity.at(x, y) / 255.0;
            const auto i = static_cast<std::size_t>(y * mask.width + x);
            if (mask.at(x, y) != 0) {
                ++num;
                shares.bare += 1.0 - opacity;
                const double green = photo.bgr[3 * i + 1] / 255.0;
                const double red = photo.bgr[3 * i + 2] / 255.0;
                const bool is_green =
                    std::abs(green - kPaint.y()) < 0.03 && std::abs(red - kPaint.x()) < 0.03;
                shares.wrong += opacity > 0.99 && !is_green ? 1.0 : 0.0;
            } else if (opacity > 0.0 && is_far_off(mask, x, y)) {
                shares.far_off += opacity;
            }
        }
    }
    shares.bare /= num;
    shares.far_off /= num;
    shares.wrong /= num;
    return shares;
}

class DrawnOutline : public testing::Test {
protected:
    void SetUp() override {
        auto photographer = test::PersonPhotographer::create();
        ASSERT_TRUE(photographer) << photographer.error().message;
        photographer_.emplace(std::move(*photographer));
    }
    test::Photo take(const PersonModel& model,
                     const geometry::CalibratedCamera& camera,
                     bool is_soft) {
        PersonDrawing person;
        person.set_model(model);
        photographer_->set_soft_outlines(is_soft);
        return photographer_->take(camera, person);
    }
    // Six degrees beside a camera of the ring.
    static geometry::CalibratedCamera beside_a_camera() {
        constexpr double kAngle = 6.0 * M_PI / 180.0;
        return synthetic::camera_at(
            kMiddle + 3.0 * Eigen::Vector3d(std::cos(kAngle), std::sin(kAngle), 0.1), kMiddle);
    }

    std::optional<test::PersonPhotographer> photographer_;
};

// As if calibration or masks of other cameras had cut the hull.
TEST_F(DrawnOutline, ShowsWhatNearCamerasSawBeyondTheHull) {
    const PersonModel model = sphere_model(kRadius_m - kShrunk_m);
    for (const auto& camera : {synthetic::ring(kNumCameras, kMiddle)[3], beside_a_camera()}) {
        const image::Mask mask = true_mask({{kMiddle, kRadius_m}}, camera);
        const Shares hard = shares_of(take(model, camera, false), mask);
        const Shares soft = shares_of(take(model, camera, true), mask);
        EXPECT_GT(hard.bare, 0.02);
        EXPECT_LT(soft.bare, 0.35 * hard.bare);
        EXPECT_LT(soft.wrong, 0.001);
    }
}

TEST_F(DrawnOutline, IsThatOfTheMaskAtACamerasPlace) {
    for (const double less_m : {0.0, 0.5 * kShrunk_m, kShrunk_m}) {
        const PersonModel model = sphere_model(kRadius_m - less_m);
        const auto camera = synthetic::ring(kNumCameras, kMiddle)[1];
        const image::Mask mask = true_mask({{kMiddle, kRadius_m}}, camera);
        const Shares soft = shares_of(take(model, camera, true), mask);
        EXPECT_LT(soft.bare, 0.006);
        EXPECT_EQ(soft.far_off, 0.0);
        EXPECT_LT(soft.wrong, 0.001);
    }
}

// An arm before the trunk.
TEST_F(DrawnOutline, IsCoveredByThePerson) {
    const std::vector<Sphere> true_shape{{kMiddle, kRadius_m}, {{0.55, 0.0, 1.1}, 0.15}};
    std::vector<Sphere> hull = true_shape;
    for (Sphere& sphere : hull) sphere.radius_m -= kShrunk_m;
    const PersonModel model = model_of(hull, true_shape);
    const auto camera = synthetic::camera_at({3.0, 0.4, 1.0}, kMiddle);
    const test::Photo hard = take(model, camera, false);
    const test::Photo soft = take(model, camera, true);
    int num_equal = 0;
    int num_added = 0;
    for (int y = 1; y + 1 < hard.height; ++y) {
        for (int x = 1; x + 1 < hard.width; ++x) {
            const auto i = static_cast<std::size_t>(y * hard.width + x);
            if (hard.opacity.at(x, y) == 0) {
                num_added += soft.opacity.at(x, y) > 0 ? 1 : 0;
                continue;
            }
            // not the pixels at the edge, which are means
            if ((hard.opacity.at(x - 1, y) & hard.opacity.at(x + 1, y) & hard.opacity.at(x, y - 1) &
                 hard.opacity.at(x, y + 1)) == 0)
                continue;
            ++num_equal;
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_EQ(hard.bgr[3 * i + c], soft.bgr[3 * i + c]) << x << " " << y;
        }
    }
    EXPECT_GT(num_equal, 10'000);
    EXPECT_GT(num_added, 100);
}

}  // namespace
}  // namespace atrium::renderer
