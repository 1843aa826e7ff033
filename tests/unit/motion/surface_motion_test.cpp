#include "site_node/motion/surface_motion.hpp"

#include "core/base/thread_pool.hpp"
#include "site_node/texture/texture.hpp"
#include "tests/support/pictures/surface_painter.hpp"
#include "tests/support/shapes/bounding_rect.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/world/physics_meshes.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

namespace atrium::motion {
namespace {

using Eigen::Vector3d;

constexpr std::chrono::nanoseconds kPeriod{33'333'333};
const double kPeriodS = std::chrono::duration<double>(kPeriod).count();
const Vector3d kMiddle(0.0, 0.0, 0.9);

// A body that turns about its middle and moves.
struct Motion {
    Vector3d velocity = Vector3d::Zero();
    Vector3d turn = Vector3d::Zero();  // [rad/s]

    Vector3d place(const Vector3d& at_rest, double time_s) const {
        const double angle = turn.norm() * time_s;
        const Eigen::AngleAxisd rotation(
            angle, angle > 0.0 ? Vector3d(turn.normalized()) : Vector3d::UnitZ());
        return kMiddle + rotation * (at_rest - kMiddle) + time_s * velocity;
    }
};

double textured(const Vector3d& place) {
    return 130.0 + 35.0 * test::noise_at(place, 25.0) + 25.0 * test::noise_at(place, 60.0);
}
double plain(const Vector3d&) { return 130.0; }

class Studio {
public:
    explicit Studio(geometry::TriangleMesh at_rest)
        : at_rest_(std::move(at_rest)),
          cameras_(test::make_ring_rig({.size_px = 640, .focal_px = 700.0})) {
        for (const auto& camera : cameras_) painters_.emplace_back(camera);
    }

    const std::vector<geometry::CalibratedCamera>& cameras() const { return cameras_; }
    geometry::TriangleMesh mesh(const Motion& motion, double time_s) const {
        geometry::TriangleMesh mesh = at_rest_;
        for (Vector3d& vertex : mesh.vertices) vertex = motion.place(vertex, time_s);
        return mesh;
    }
    std::vector<MotionPicture> take(const geometry::TriangleMesh& mesh,
                                    const test::SurfacePainter::Paint& paint) {
        std::vector<MotionPicture> pictures(cameras_.size());
        texture::TextureScratch scratch;
        for (std::size_t i = 0; i < cameras_.size(); ++i) {
            painters_[i].draw(mesh, at_rest_.vertices, paint, random_);
            const image::Mask& mask = painters_[i].mask();
            codec::TextureCrop crop;
            if (texture::crop_texture(
                    painters_[i].picture(), mask, test::bounding_rect(mask), {}, scratch, crop))
                reduce(crop, pictures[i]);
        }
        return pictures;
    }
    // The motion found between two pictures that are a period apart.
    geometry::MotionField find(SurfaceMotion& surface_motion,
                               const Motion& motion,
                               const test::SurfacePainter::Paint& paint,
                               Executor& executor) {
        geometry::MotionField field;
        for (int i = 0; i < 2; ++i) {
            const geometry::TriangleMesh now = mesh(motion, i * kPeriodS);
            auto pictures = take(now, paint);
            surface_motion.estimate(
                now, pictures, Timestamp{} + (i + 30) * kPeriod, executor, field);
        }
        return field;
    }
    geometry::MotionField find(const Motion& motion, const test::SurfacePainter::Paint& paint) {
        SurfaceMotion surface_motion(cameras_);
        SerialExecutor executor;
        return find(surface_motion, motion, paint, executor);
    }

    // Medians over the vertices at the end of the motion.
    struct Judged {
        double error_mps = 0.0;
        double found_mps = 0.0;
        double confidence = 0.0;
    };
    Judged judge(const geometry::MotionField& field, const Motion& motion) const {
        std::vector<double> errors, found, confidences;
        for (const Vector3d& vertex : at_rest_.vertices) {
            const Vector3d now = motion.place(vertex, kPeriodS);
            const Vector3d truth = (now - motion.place(vertex, 0.0)) / kPeriodS;
            const geometry::FoundMotion at = field.at(now.cast<float>());
            errors.push_back((at.velocity.cast<double>() - truth).norm());
            found.push_back(static_cast<double>(at.velocity.norm()));
            confidences.push_back(static_cast<double>(at.confidence));
        }
        const auto median = [](std::vector<double>& values) {
            const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
            std::ranges::nth_element(values, middle);
            return *middle;
        };
        return {median(errors), median(found), median(confidences)};
    }

private:
    geometry::TriangleMesh at_rest_;
    std::vector<geometry::CalibratedCamera> cameras_;
    std::vector<test::SurfacePainter> painters_;
    test::Random random_{11};
};

geometry::TriangleMesh sphere() { return physics_test::make_sphere_mesh(0.3, kMiddle, 40); }

// No outline shows it: only the pictures do.
TEST(SurfaceMotion, SphereThatTurnsInPlaceMovesAlongItself) {
    Studio studio(sphere());
    for (const Vector3d& turn : {Vector3d(0.0, 0.0, 3.0), Vector3d(1.5, -1.0, 0.5)}) {
        const Motion motion{Vector3d::Zero(), turn};
        const auto judged = studio.judge(studio.find(motion, textured), motion);
        EXPECT_LT(judged.error_mps, 0.06) << turn.transpose();
        EXPECT_GT(judged.found_mps, 0.3 * turn.norm() * 0.5);
        EXPECT_GT(judged.confidence, 0.5);
    }
}

TEST(SurfaceMotion, FindsTheVelocityOfABoxInEveryDirection) {
    Studio studio(physics_test::make_box_mesh(
        {0.4, 0.3, 0.5}, {Eigen::Quaterniond::Identity(), kMiddle}, 10));
    test::Random random(5);
    for (const double speed : {0.3, 1.0, 2.5}) {
        const Motion motion{speed * test::random_direction(random), Vector3d(0.0, 0.3, 0.5)};
        const auto judged = studio.judge(studio.find(motion, textured), motion);
        EXPECT_LT(judged.error_mps, std::max(0.05, 0.05 * speed)) << speed;
    }
}

TEST(SurfaceMotion, WithoutTextureItInventsNoTurn) {
    Studio studio(sphere());
    const Motion motion{Vector3d::Zero(), Vector3d(0.0, 0.0, 3.0)};
    const auto field = studio.find(motion, plain);
    ASSERT_FALSE(field.empty());
    for (const geometry::MotionCell& cell : field.cells()) EXPECT_TRUE(cell.velocity.allFinite());
    // a third of a reduced pixel per picture, of the 0.46 m/s that one pixel is
    EXPECT_LT(studio.judge(field, motion).found_mps, 0.15);
}

TEST(SurfaceMotion, GivesTheSameBitsWithAnyNumberOfWorkers) {
    Studio studio(sphere());
    const Motion motion{Vector3d(0.5, 0.0, 0.2), Vector3d(0.0, 1.0, 0.0)};
    Studio again(sphere());  // the same noise
    SurfaceMotion one(studio.cameras());
    SurfaceMotion many(studio.cameras());
    SerialExecutor serial;
    ThreadPool pool(3);
    const auto alone = studio.find(one, motion, textured, serial);
    const auto shared = again.find(many, motion, textured, pool);
    ASSERT_EQ(alone.cells().size(), shared.cells().size());
    ASSERT_FALSE(alone.empty());
    for (std::size_t i = 0; i < alone.cells().size(); ++i) {
        EXPECT_EQ(alone.cells()[i].velocity, shared.cells()[i].velocity);
        EXPECT_EQ(alone.cells()[i].confidence, shared.cells()[i].confidence);
    }
}

TEST(SurfaceMotion, CamerasThatSeeNobodySayNothing) {
    Studio studio(sphere());
    const Motion motion{Vector3d(0.8, -0.4, 0.1), Vector3d::Zero()};
    SurfaceMotion surface_motion(studio.cameras());
    SerialExecutor executor;
    geometry::MotionField field;
    for (int i = 0; i < 2; ++i) {
        const auto now = studio.mesh(motion, i * kPeriodS);
        auto pictures = studio.take(now, textured);
        for (std::size_t camera = 0; camera < pictures.size(); camera += 2)
            pictures[camera].rect = {};
        surface_motion.estimate(now, pictures, Timestamp{} + (i + 30) * kPeriod, executor, field);
    }
    EXPECT_LT(studio.judge(field, motion).error_mps, 0.1);
}

TEST(SurfaceMotion, IsUnknownAtFirstAndAfterAGap) {
    Studio studio(sphere());
    const auto mesh = studio.mesh({}, 0.0);
    const auto pictures = studio.take(mesh, textured);
    SurfaceMotion surface_motion(studio.cameras());
    SerialExecutor executor;
    geometry::MotionField field;
    const auto is_known_at = [&](std::chrono::milliseconds time) {
        auto taken = pictures;
        surface_motion.estimate(mesh, taken, Timestamp{} + time, executor, field);
        return !field.empty();
    };
    using std::chrono::milliseconds;
    EXPECT_FALSE(is_known_at(milliseconds(1000)));
    EXPECT_TRUE(is_known_at(milliseconds(1033)));
    EXPECT_FALSE(is_known_at(milliseconds(1233)));  // after a gap
    EXPECT_TRUE(is_known_at(milliseconds(1266)));
    EXPECT_FALSE(is_known_at(milliseconds(1266)));  // no time has passed
    surface_motion.forget();
    EXPECT_FALSE(is_known_at(milliseconds(1300)));
}

}  // namespace
}  // namespace atrium::motion
