#include "core/base/thread_pool.hpp"
#include "site_node/pipeline.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/winding_number.hpp"
#include "tests/unit/site_node/capsule_room.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace atrium::site_node {
namespace {

constexpr std::size_t kSleeve = 5;  // limb whose colour is that of camera 0's wall
constexpr double kMargin_m = 0.025;
const geometry::Aabb kSpaceOfRoom{{-0.8, -0.9, 0.0}, {0.8, 0.9, 2.0}};

struct Paint {
    double y = 0.0;
    double u = 0.0;
    double v = 0.0;
};
constexpr Paint kLightWall{180.0, 128.0, 128.0};  // of camera 0
constexpr Paint kOtherWalls{100.0, 100.0, 150.0};
constexpr Paint kClothes{60.0, 150.0, 110.0};
constexpr Paint kLightCloth{164.0, 128.0, 128.0};

config::Rig make_room(int num_cameras) {
    config::Rig rig;
    rig.cameras = atrium::test::make_ring_rig({.num_cameras = num_cameras,
                                               .radius_m = 3.0,
                                               .heights_m = {1.0, 2.2},
                                               .size_px = 400,
                                               .focal_px = 460.0});
    rig.cameras[1].intrinsics.distortion = {-0.2, 0.05, 0.001, -0.001, 0.0};
    return rig;
}

// Paints a wall, or what the camera sees of the limbs before it. All has a pattern, and noise.
class Painter {
public:
    explicit Painter(std::uint64_t seed) : random_(seed) {}

    template <typename PaintAt>  // of a pixel; nullptr: it stays as it is
    void paint(const PaintAt& paint_at, image::YuvImage& out) {
        constexpr double kPattern = 4.0;
        for (int y = 0; y < out.height(); ++y) {
            for (int x = 0; x < out.width(); ++x) {
                if (const Paint* paint = paint_at(x, y))
                    out.y.row(y)[x] = byte(paint->y + kPattern * pattern(x) * pattern(y));
            }
        }
        for (int y = 0; y < out.height() / 2; ++y) {
            for (int x = 0; x < out.width() / 2; ++x) {
                const Paint* paint = paint_at(2 * x, 2 * y);
                if (paint == nullptr) continue;
                out.u.row(y)[x] = byte(paint->u);
                out.v.row(y)[x] = byte(paint->v);
            }
        }
    }

private:
    static double pattern(int at) { return std::sin(0.2 * at); }
    std::uint8_t byte(double value) {
        return static_cast<std::uint8_t>(
            std::clamp(std::lround(value + noise_(random_)), 0L, 255L));
    }

    std::mt19937_64 random_;
    std::normal_distribution<double> noise_{0.0, 1.0};
};

// Eight cameras, each before a wall of one colour.
class WalledRoom final : public test::StillSource {
public:
    using StillSource::StillSource;
    bool has_silhouettes() const override { return false; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token) override {
        for (const std::size_t camera : cameras)
            for (std::uint64_t seed = 0; sink(camera, *empty(camera, seed)) && seed < 5;) ++seed;
        return std::vector<Expected<void>>(cameras.size());
    }

    std::shared_ptr<image::YuvImage> empty(std::size_t camera, std::uint64_t seed) const {
        const geometry::PinholeCamera& lens = rig().cameras[camera].intrinsics;
        auto picture = std::make_shared<image::YuvImage>();
        picture->y = image::Plane(lens.width, lens.height);
        picture->u = picture->v = image::Plane(lens.width / 2, lens.height / 2);
        const Paint& wall = camera == 0 ? kLightWall : kOtherWalls;
        Painter(100 * seed + camera).paint([&](int, int) { return &wall; }, *picture);
        return picture;
    }
};

class Camouflage : public testing::Test {
protected:
    // The body before a wall; `sleeve` is the colour of one of its arms.
    void film(const std::vector<test::Capsule>& body,
              const Paint& sleeve,
              std::size_t camera,
              image::YuvImage& picture) const {
        const image::Plane limbs = test::limbs_in_front(body, room_.rig().cameras[camera]);
        const auto paint_at = [&](int x, int y) -> const Paint* {
            if (limbs.at(x, y) == 0) return nullptr;
            return limbs.at(x, y) == kSleeve + 1 ? &sleeve : &kClothes;
        };
        Painter(7 + camera).paint(paint_at, picture);
    }
    capture::Metaframe film(const std::vector<test::Capsule>& body, const Paint& sleeve) const {
        capture::Metaframe metaframe;
        for (std::size_t i = 0; i < room_.rig().cameras.size(); ++i) {
            auto picture = room_.empty(i, 1000);
            film(body, sleeve, i, *picture);
            metaframe.frames.push_back({i, {}, image::RawImage(std::move(picture)), nullptr});
        }
        return metaframe;
    }
    Pipeline make(const PipelineOptions& options) {
        auto pipeline = Pipeline::create(room_, options, {});
        EXPECT_TRUE(pipeline) << pipeline.error().message;
        return std::move(*pipeline);
    }
    void process(Pipeline& pipeline, const capture::Metaframe& metaframe) {
        const auto done = pipeline.process(metaframe, executor_, frame_);
        ASSERT_TRUE(done) << done.error().message;
    }
    // Share of the points inside a limb that the hull contains.
    double share_of(const test::Capsule& limb) const {
        const std::vector<Eigen::Vector3d> points = test::points_inside({&limb, 1}, kMargin_m, 200);
        const auto inside = std::ranges::count_if(points, [&](const Eigen::Vector3d& p) {
            return std::lround(atrium::test::winding_number(frame_.hull.mesh, p)) == 1;
        });
        return static_cast<double>(inside) / static_cast<double>(points.size());
    }

    WalledRoom room_{make_room(8)};
    const std::vector<test::Capsule> body_ = test::make_body({0, 0, 0});
    PipelineOptions options_ = [] {
        PipelineOptions options;
        options.hull.bounds = kSpaceOfRoom;
        return options;
    }();
    SerialExecutor executor_;
    SiteFrame frame_;
};

TEST_F(Camouflage, OfOneCameraCostsNobodyAnArm) {
    const capture::Metaframe metaframe = film(body_, kLightCloth);
    options_.hull.find_camouflaged = false;
    Pipeline alone = make(options_);
    process(alone, metaframe);
    EXPECT_LT(share_of(body_[kSleeve]), 0.3) << "camera 0 should not see the sleeve";
    EXPECT_EQ(frame_.num_camouflaged_px, 0u);

    options_.hull.find_camouflaged = true;
    Pipeline pipeline = make(options_);
    process(pipeline, metaframe);
    EXPECT_GT(share_of(body_[kSleeve]), 0.98);
    for (const test::Capsule& limb : body_) EXPECT_GT(share_of(limb), 0.98);
    EXPECT_GT(frame_.num_camouflaged_px, 300u);
    const double with_m3 = geometry::volume_m3(frame_.hull.mesh);

    // no more than where camera 0 sees the arm by itself
    process(pipeline, film(body_, kClothes));
    EXPECT_LT(with_m3, 1.01 * geometry::volume_m3(frame_.hull.mesh));
}

TEST_F(Camouflage, IsNothingThatCamerasSeeThemselves) {
    const capture::Metaframe metaframe = film(body_, kClothes);
    Pipeline pipeline = make(options_);
    process(pipeline, metaframe);
    EXPECT_EQ(frame_.num_camouflaged_px, 0u);
    const std::vector<Eigen::Vector3d> vertices = frame_.hull.mesh.vertices;
    options_.hull.find_camouflaged = false;
    Pipeline alone = make(options_);
    process(alone, metaframe);
    EXPECT_EQ(frame_.hull.mesh.vertices, vertices);
}

// All others see a dark sleeve where camera 0 sees the wall in a shadow: that is not its colour.
TEST_F(Camouflage, IsNoShadowOnTheWall) {
    capture::Metaframe metaframe = film(body_, kClothes);
    const auto shadow = room_.empty(0, 1000);
    for (int y = 0; y < shadow->height(); ++y) {
        for (int x = 110; x < 290; ++x)
            shadow->y.row(y)[x] = static_cast<std::uint8_t>(0.8 * shadow->y.row(y)[x]);
    }
    film({body_.begin(), body_.begin() + kSleeve}, kClothes, 0, *shadow);
    metaframe.frames[0].image = image::RawImage(shadow);
    Pipeline pipeline = make(options_);
    process(pipeline, metaframe);
    EXPECT_EQ(frame_.num_camouflaged_px, 0u);
}

// A quarter of space is searched at each instant; what was found elsewhere moves on.
TEST_F(Camouflage, IsFollowedBetweenTwoSearches) {
    Pipeline pipeline = make(options_);
    for (int instant = 0; instant < 6; ++instant) {
        SCOPED_TRACE(instant);
        const std::vector<test::Capsule> body =
            test::make_body({0.008 * instant, 0.01 * instant, 0});
        process(pipeline, film(body, kLightCloth));
        EXPECT_GT(share_of(body[kSleeve]), 0.95);
    }
}

TEST_F(Camouflage, IsNotLookedForWhereACameraDoesNotLook) {
    CameraAreas areas;
    areas.name = "cam0";
    areas.areas.exclude = {{{0, 0}, {399, 0}, {399, 200}, {0, 200}}};
    options_.areas = {areas};
    Pipeline pipeline = make(options_);
    process(pipeline, film(body_, kLightCloth));
    EXPECT_LT(share_of(body_[kSleeve]), 0.3);
}

TEST_F(Camouflage, NeedsBoundsAndFiveOtherCameras) {
    options_.hull.bounds.reset();
    EXPECT_FALSE(CamouflageStage::create(room_.rig().cameras, options_.hull));
    options_.hull.regions = {{"here", kSpaceOfRoom, {}}};
    EXPECT_TRUE(CamouflageStage::create(room_.rig().cameras, options_.hull));
    const std::span<const geometry::CalibratedCamera> five(room_.rig().cameras.data(), 5);
    EXPECT_FALSE(CamouflageStage::create(five, options_.hull));
    options_.hull.regions[0].bounds.max = {1e9, 1e9, 1e9};
    EXPECT_FALSE(CamouflageStage::create(room_.rig().cameras, options_.hull));
    options_.hull.regions[0].bounds = kSpaceOfRoom;
    options_.hull.find_camouflaged = false;
    EXPECT_FALSE(CamouflageStage::create(room_.rig().cameras, options_.hull));
}

TEST_F(Camouflage, IsTheSameForAnyNumberOfWorkers) {
    const capture::Metaframe metaframe = film(body_, kLightCloth);
    Pipeline pipeline = make(options_);
    process(pipeline, metaframe);
    const std::vector<Eigen::Vector3d> vertices = frame_.hull.mesh.vertices;
    ThreadPool pool(3);
    Pipeline parallel = make(options_);
    ASSERT_TRUE(parallel.process(metaframe, pool, frame_));
    EXPECT_EQ(frame_.hull.mesh.vertices, vertices);
}

TEST(CameraEye, ProjectsAsItsLensAndNothingFromBesideThePicture) {
    geometry::CalibratedCamera camera = make_room(8).cameras[1];
    camera.intrinsics.skew = 0.7;
    camera.intrinsics.distortion = {-0.3, 0.1, 0.002, -0.001, -0.01};
    const camouflage::CameraEye eye(camera);
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    int num_seen = 0;
    for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector3d at(unit(random), unit(random), 1.0 + unit(random));
        const Eigen::Vector3d in_camera =
            camera.camera_from_site.rotation * at + camera.camera_from_site.translation;
        const Eigen::Vector2d px = camera.intrinsics.distort(camera.intrinsics.project(in_camera));
        const camouflage::CameraEye::Place place = eye.place_of(at.cast<float>());
        if (!place.is_in_picture) continue;
        ++num_seen;
        EXPECT_LT((place.px.cast<double>() - px).norm(), 0.01);
        EXPECT_NEAR(place.depth_m, in_camera.z(), 1e-5);
        const Eigen::Vector3f back = eye.point_site(eye.ray_camera(place.px), place.depth_m);
        EXPECT_LT((back.cast<double>() - at).norm(), 1e-3);
    }
    EXPECT_GT(num_seen, 1000);
    // behind it, and where this lens model bends rays back into the picture
    const auto point = [&](double x, double y, double z) {
        return Eigen::Vector3f(
            (camera.camera_from_site.inverse().rotation * Eigen::Vector3d(x, y, z) +
             camera.centre_site())
                .cast<float>());
    };
    EXPECT_FALSE(eye.place_of(point(0, 0, -1)).is_in_picture);
    EXPECT_FALSE(eye.place_of(point(0, 0, 0)).is_in_picture);
    for (double x = 1.0; x < 20.0; x *= 1.1)
        EXPECT_FALSE(eye.place_of(point(x, 0.2, 1)).is_in_picture) << x;
}

}  // namespace
}  // namespace atrium::site_node
