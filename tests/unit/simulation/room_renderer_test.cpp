#include "simulation/room_renderer.hpp"

#include "tests/unit/simulation/rig_fixture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numeric>

namespace atrium::simulation {
namespace {

constexpr double kTimeS = 0.5;

// Plain scan conversion of a mesh into a camera's picture, without GL: the pixels that it must
// cover.
image::Mask projection_of(const geometry::TriangleMesh& mesh,
                          const geometry::CalibratedCamera& camera) {
    image::Mask mask(camera.intrinsics.width, camera.intrinsics.height);
    std::vector<Eigen::Vector2d> px;
    for (const Eigen::Vector3d& p : mesh.vertices) {
        px.push_back(
            camera.intrinsics.distort(camera.intrinsics.project(camera.camera_from_site * p)));
    }
    const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return a.x() * b.y() - a.y() * b.x();
    };
    for (const auto& t : mesh.triangles) {
        const Eigen::Vector2d &a = px[t[0]], &b = px[t[1]], &c = px[t[2]];
        const double area = cross(b - a, c - a);
        if (area == 0.0) continue;
        const Eigen::Vector2d low = a.cwiseMin(b).cwiseMin(c);
        const Eigen::Vector2d high = a.cwiseMax(b).cwiseMax(c);
        for (int y = std::max(0, static_cast<int>(std::ceil(low.y())));
             y <= std::min(mask.height - 1.0, high.y());
             ++y) {
            for (int x = std::max(0, static_cast<int>(std::ceil(low.x())));
                 x <= std::min(mask.width - 1.0, high.x());
                 ++x) {
                const Eigen::Vector2d p(x, y);
                const double u = cross(b - a, p - a) / area;
                const double v = cross(c - b, p - b) / area;
                const double w = cross(a - c, p - c) / area;
                if (u >= 0.0 && v >= 0.0 && w >= 0.0) mask.row(y)[x] = 255;
            }
        }
    }
    return mask;
}

bool any_near(const image::Mask& mask, int x, int y, int radius) {
    for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
            const int xx = x + dx;
            const int yy = y + dy;
            if (xx >= 0 && yy >= 0 && xx < mask.width && yy < mask.height && mask.at(xx, yy) != 0)
                return true;
        }
    }
    return false;
}

// Number of pixels of `a` without a pixel of `b` within one pixel.
int num_away(const image::Mask& a, const image::Mask& b) {
    int num = 0;
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) num += a.at(x, y) != 0 && !any_near(b, x, y, 1);
    }
    return num;
}

std::size_t num_set(const image::Mask& mask) {
    return static_cast<std::size_t>(std::count(mask.data.begin(), mask.data.end(), 255));
}

// All people at `kTimeS`.
geometry::TriangleMesh truth_of(const RoomRenderer& renderer, const RoomOptions& options) {
    geometry::TriangleMesh all;
    for (int i = 0; i < options.num_people; ++i) {
        const double own_s = time_of_person_s(options, i, kTimeS);
        const geometry::TriangleMesh one = renderer.person(static_cast<std::size_t>(i)).mesh(own_s);
        const auto first = static_cast<std::uint32_t>(all.vertices.size());
        all.vertices.insert(all.vertices.end(), one.vertices.begin(), one.vertices.end());
        for (const auto& [a, b, c] : one.triangles)
            all.triangles.push_back({first + a, first + b, first + c});
    }
    return all;
}

void expect_mask_is_projection(RoomRenderer& renderer, const RoomOptions& options) {
    const geometry::TriangleMesh truth = truth_of(renderer, options);
    for (std::size_t i = 0; i < renderer.cameras().size(); ++i) {
        image::YuvImage picture;
        image::Mask mask;
        renderer.render(kTimeS, i, Scene::kPerson, 0, picture, &mask);
        const image::Mask projection = projection_of(truth, renderer.cameras()[i]);
        ASSERT_GT(num_set(mask), 1000u) << "camera " << i;
        EXPECT_EQ(num_away(mask, projection), 0) << "camera " << i;
        EXPECT_EQ(num_away(projection, mask), 0) << "camera " << i;
        // half-covered pixels count as person: two of four samples, an eighth of a pixel along the
        // outline
        const auto area = static_cast<double>(num_set(projection));
        EXPECT_NEAR(static_cast<double>(num_set(mask)), area, 0.05 * area) << "camera " << i;
    }
}

RoomRenderer make_renderer(const std::vector<geometry::CalibratedCamera>& cameras,
                           const RoomOptions& options) {
    auto renderer = RoomRenderer::create(cameras, options);
    EXPECT_TRUE(renderer) << renderer.error().message;
    return *std::move(renderer);
}

double deviation_of_difference(const image::Plane& a, const image::Plane& b) {
    double sum = 0.0;
    double sum_sq = 0.0;
    for (std::size_t i = 0; i < a.data.size(); ++i) {
        const double d = double(a.data[i]) - double(b.data[i]);
        sum += d;
        sum_sq += d * d;
    }
    const double n = static_cast<double>(a.data.size());
    return std::sqrt(sum_sq / n - (sum / n) * (sum / n));
}

// Mean Y, U, V over the mask in its middle third of rows: trunk and arms.
std::array<double, 3> mean_colour(const image::YuvImage& picture, const image::Mask& mask) {
    std::array<double, 3> sum{};
    double n = 0.0;
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            if (mask.at(x, y) == 0) continue;
            sum[0] += picture.y.at(x, y);
            sum[1] += picture.u.at(x / 2, y / 2);
            sum[2] += picture.v.at(x / 2, y / 2);
            n += 1.0;
        }
    }
    for (double& s : sum) s /= n;
    return sum;
}

// One renderer, shared by the tests that do not change it.
class RoomRendererTest : public testing::Test {
protected:
    static void SetUpTestSuite() {
        renderer = std::make_unique<RoomRenderer>(make_renderer(ring(8), RoomOptions{}));
    }
    static void TearDownTestSuite() { renderer.reset(); }
    static std::unique_ptr<RoomRenderer> renderer;
};
std::unique_ptr<RoomRenderer> RoomRendererTest::renderer;

TEST_F(RoomRendererTest, TrueMaskIsTheProjectionOfTheGroundTruth) {
    expect_mask_is_projection(*renderer, {});
}

TEST(RoomRendererPeople, TrueMaskIsTheProjectionOfAll) {
    RoomOptions options;
    options.motion = "stroll";
    for (int num_people = 2; num_people <= kMaxPeople; ++num_people) {
        SCOPED_TRACE(num_people);
        options.num_people = num_people;
        RoomRenderer renderer = make_renderer(ring(3), options);
        expect_mask_is_projection(renderer, options);
        const geometry::TriangleMesh& mesh = renderer.person(1).mesh(kTimeS);
        EXPECT_NE(renderer.person(0).look().name, renderer.person(1).look().name);
        EXPECT_GT((mesh.vertices.front() - renderer.person(0).mesh(kTimeS).vertices.front()).norm(),
                  1.0);
    }
}

// Where two people overlap in a picture, it is that of the nearer one alone.
TEST(RoomRendererPeople, TheNearerOneCoversTheOther) {
    RoomOptions options;
    options.num_people = 2;
    options.motion = "walk";
    options.noise_lsb = 0.0;
    const std::vector<geometry::CalibratedCamera> cameras = ring(8);
    RoomRenderer both = make_renderer(cameras, options);
    const std::array<RoomOptions, 2> own = {options_of_person(options, 0),
                                            options_of_person(options, 1)};
    std::array<RoomRenderer, 2> alone = {make_renderer(cameras, own[0]),
                                         make_renderer(cameras, own[1])};
    const std::array<double, 2> time_s = {kTimeS, kTimeS + 0.12 * options.loop_s};
    int num_told_apart = 0;
    for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
        std::array<image::YuvImage, 2> pictures;
        std::array<image::Mask, 2> masks;
        for (std::size_t i = 0; i < 2; ++i)
            alone[i].render(time_s[i], camera, Scene::kPerson, 0, pictures[i], &masks[i]);
        image::YuvImage picture;
        both.render(kTimeS, camera, Scene::kPerson, 0, picture);
        const Eigen::Vector3d centre = cameras[camera].centre_site();
        const std::size_t nearer =
            (own[0].position_m - centre).norm() < (own[1].position_m - centre).norm() ? 0 : 1;
        int num = 0;
        int num_wrong = 0;
        for (int y = 0; y < picture.height(); ++y) {
            for (int x = 0; x < picture.width(); ++x) {
                if (masks[1 - nearer].at(x, y) == 0 || masks[nearer].at(x, y) == 0) continue;
                const int near = pictures[nearer].y.at(x, y);
                const int far = pictures[1 - nearer].y.at(x, y);
                // each lamp hangs over its room's middle, so that shades differ
                constexpr int kShades = 50;
                if (std::abs(near - far) < kShades) continue;
                ++num;
                const int seen = picture.y.at(x, y);
                num_wrong += std::abs(seen - near) > std::abs(seen - far) ? 1 : 0;
            }
        }
        EXPECT_LE(num_wrong, num / 20) << "camera " << camera << ": outlines of " << num;
        num_told_apart += num;
    }
    EXPECT_GT(num_told_apart, 500);
}

TEST_F(RoomRendererTest, TrueMaskOfTheEmptyRoomIsEmpty) {
    image::YuvImage picture;
    image::Mask mask;
    renderer->render(kTimeS, 0, Scene::kEmptyRoom, 0, picture, &mask);
    EXPECT_EQ(num_set(mask), 0u);
    EXPECT_EQ(picture.width(), 320);
    EXPECT_EQ(picture.height(), 240);
}

TEST_F(RoomRendererTest, FrontBackLeftAndRightDiffer) {
    std::vector<std::array<double, 3>> colours;
    for (const std::size_t camera : {0u, 2u, 4u, 6u}) {
        image::YuvImage picture;
        image::Mask mask;
        renderer->render(kTimeS, camera, Scene::kPerson, 0, picture, &mask);
        colours.push_back(mean_colour(picture, mask));
    }
    const auto distance = [&](std::size_t a, std::size_t b) {
        double sum = 0.0;
        for (std::size_t i = 0; i < 3; ++i) sum += std::abs(colours[a][i] - colours[b][i]);
        return sum;
    };
    EXPECT_GT(distance(0, 2), 12.0) << "front and back";
    EXPECT_GT(distance(1, 3), 12.0) << "left and right";
}

TEST_F(RoomRendererTest, PicturesOfTheEmptyRoomDifferByNoiseAlone) {
    image::YuvImage a, b;
    renderer->render(0.0, 1, Scene::kEmptyRoom, 0, a);
    renderer->render(0.0, 1, Scene::kEmptyRoom, 1, b);
    // Channels have noise of 2 LSB each. Luma weighs them by 0.299, 0.587, 0.114. The two pictures
    // are independent, and rounding adds a little.
    const double expected = 2.0 * std::sqrt(2.0 * (0.299 * 0.299 + 0.587 * 0.587 + 0.114 * 0.114));
    EXPECT_NEAR(deviation_of_difference(a.y, b.y), expected, 0.15 * expected);
    EXPECT_GT(deviation_of_difference(a.u, b.u), 0.3);
    EXPECT_LT(deviation_of_difference(a.u, b.u), 1.6);
}

TEST_F(RoomRendererTest, PersonChangesOnlyItsPixelsAndItsShadow) {
    image::YuvImage with, without;
    image::Mask mask;
    for (std::size_t camera = 0; camera < 8; ++camera) {
        renderer->render(kTimeS, camera, Scene::kPerson, 0, with, &mask);
        renderer->render(kTimeS, camera, Scene::kEmptyRoom, 0, without);
        int num_brighter = 0;
        int num_shadow = 0;
        for (int y = 0; y < mask.height; ++y) {
            for (int x = 0; x < mask.width; ++x) {
                if (any_near(mask, x, y, 1)) continue;
                const int change = with.y.at(x, y) - without.y.at(x, y);
                num_brighter += change > 14;  // 8 sigma
                num_shadow += change < -0.25 * without.y.at(x, y);
            }
        }
        EXPECT_EQ(num_brighter, 0) << "camera " << camera;
        EXPECT_GT(num_shadow, 100) << "camera " << camera;
    }
}

TEST_F(RoomRendererTest, ShadowOnTheFloorIsSoftAndNotBlack) {
    // camera 2 looks from the person's left across the shadow, which falls away from the lamp
    image::YuvImage with, without;
    image::Mask mask;
    renderer->render(kTimeS, 2, Scene::kPerson, 0, with, &mask);
    renderer->render(kTimeS, 2, Scene::kEmptyRoom, 0, without);
    double deepest = 0.0;
    int num_half = 0;
    for (int y = 2; y + 2 < mask.height; ++y) {
        for (int x = 2; x + 2 < mask.width; ++x) {
            if (any_near(mask, x, y, 2)) continue;
            double sum_with = 0.0;
            double sum_without = 0.0;
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    sum_with += with.y.at(x + dx, y + dy);
                    sum_without += without.y.at(x + dx, y + dy);
                }
            }
            const double darkening = 1.0 - sum_with / sum_without;
            deepest = std::max(deepest, darkening);
            num_half += darkening > 0.12 && darkening < 0.28;
        }
    }
    // at most all of the lamp's light is missing: kDiffuse of kAmbient + kDiffuse, plus noise
    EXPECT_GT(deepest, 0.27);
    EXPECT_LT(deepest, 0.42);
    EXPECT_GT(num_half, 100);  // the penumbra
}

TEST(RoomRenderer, GivesTheSameBytesOnlyForTheSameSeed) {
    const auto cameras = ring(1);
    RoomOptions options;
    RoomRenderer first = make_renderer(cameras, options);
    RoomRenderer second = make_renderer(cameras, options);
    options.seed = 2;
    RoomRenderer other = make_renderer(cameras, options);
    image::YuvImage a, b, c;
    first.render(1.0, 0, Scene::kPerson, 0, a);
    second.render(0.2, 0, Scene::kPerson, 0, b);  // earlier pictures do not matter
    second.render(1.0, 0, Scene::kPerson, 0, b);
    other.render(1.0, 0, Scene::kPerson, 0, c);
    EXPECT_EQ(a.y.data, b.y.data);
    EXPECT_EQ(a.v.data, b.v.data);
    EXPECT_NE(a.y.data, c.y.data);
}

TEST(RoomRenderer, AppliesLensDistortionAndSkew) {
    auto cameras = ring(2);
    cameras[0].intrinsics.distortion = {-0.28, 0.10, 0.001, -0.0015, 0.0};
    cameras[0].intrinsics.skew = 2.0;
    cameras[1].intrinsics.distortion = {0.12, -0.05, 0.0, 0.002, 0.01};
    cameras[1].intrinsics.cx += 21.0;
    RoomRenderer renderer = make_renderer(cameras, RoomOptions{});
    expect_mask_is_projection(renderer, {});
}

TEST(RoomRenderer, TableHidesPartsBehindIt) {
    RoomOptions options;
    options.motion = "table_hands";
    // level with the table's far edge and below it: hands over the table are visible, hips behind
    // it are not
    const std::vector<geometry::CalibratedCamera> cameras = {
        camera_at({0.0, 1.6, 1.3}, {0.0, 0.0, 0.8}, 250.0, 320, 240)};
    RoomRenderer renderer = make_renderer(cameras, options);
    image::YuvImage picture;
    image::Mask mask;
    renderer.render(kTimeS, 0, Scene::kPerson, 0, picture, &mask);
    const image::Mask whole = projection_of(renderer.person().mesh(kTimeS), cameras[0]);
    EXPECT_EQ(num_away(mask, whole), 0);
    const auto at = [&](const Eigen::Vector3d& p) {
        const Eigen::Vector2d px = cameras[0].intrinsics.project(cameras[0].camera_from_site * p);
        const int x = static_cast<int>(std::lround(px.x()));
        const int y = static_cast<int>(std::lround(px.y()));
        const bool in_picture = x >= 0 && x < mask.width && y >= 0 && y < mask.height;
        return in_picture ? int{mask.at(x, y)} : 0;
    };
    EXPECT_EQ(at({0.1, -0.72, 0.45}),
              0);  // right thigh, on a line of sight that crosses the table top
    int num_over_table = 0;
    for (const Eigen::Vector3d& p : renderer.person().mesh(kTimeS).vertices) {
        if (p.head<2>().cwiseAbs().maxCoeff() < 0.45 && p.z() > kTableHeightM)
            num_over_table += at(p) != 0;
    }
    EXPECT_GT(num_over_table, 500);
}

TEST(RoomRenderer, RefusesImpossibleCameras) {
    EXPECT_FALSE(RoomRenderer::create({}, RoomOptions{}));
    auto cameras = ring(1);
    cameras[0].intrinsics.width = 319;
    const auto odd = RoomRenderer::create(cameras, RoomOptions{});
    ASSERT_FALSE(odd);
    EXPECT_THAT(odd.error().message, testing::HasSubstr("cam0"));
}

}  // namespace
}  // namespace atrium::simulation
