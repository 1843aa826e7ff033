#include "core/base/thread_pool.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/shapes/scene_maker.hpp"
#include "tools/visual_hull/coverage.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <random>

// Several thousand scenes: people, balls, boxes and rods in good, bad and degenerate rigs. Their
// silhouettes are consistent, noisy, shifted or cut by the picture.
namespace atrium::hull {
namespace {

using test::Contour;
using test::SceneOptions;

constexpr std::uint64_t kStride = test::kSanitized ? 4 : 1;
constexpr std::uint64_t kNumBlocks = 25;
constexpr std::uint64_t kScenesPerBlock = 100;
// One scene of this many is checked for everything, the others for soundness only. Coprime to
// kStride.
constexpr std::uint64_t kSubset = 3;

HullOptions exact() {
    HullOptions options;
    options.keep_phantoms = true;
    options.min_contour_area_px2 = 1e-6;  // no dropped hole can then have a pixel centre in it
    return options;
}

// Counts by outcome, of all blocks together. Printed at the end for information.
class Tally : public testing::Environment {
public:
    void count(const VisualHull& hull) {
        ++by_status_[to_string(hull.status)];
        num_retried_ += hull.num_attempts > 1 ? 1 : 0;
        num_repaired_ += hull.num_contours_repaired > 0 ? 1 : 0;
    }
    void TearDown() override {
        for (const auto& [status, number] : by_status_)
            std::printf("scenes, %s: %d\n", status, number);
        std::printf(
            "scenes that needed another jitter: %d, with outlines that cross themselves: %d\n",
            num_retried_,
            num_repaired_);
    }

private:
    std::map<const char*, int> by_status_;
    int num_retried_ = 0;
    int num_repaired_ = 0;
};

Tally& tally() {
    static auto* const environment =
        static_cast<Tally*>(testing::AddGlobalTestEnvironment(new Tally));
    return *environment;
}
[[maybe_unused]] Tally& registered = tally();  // before main

// A necessary condition for an infinite hull, from the caps of directions around the silhouettes:
// all of them meet in pairs. Independent of the hull.
bool may_be_unbounded(const std::vector<SilhouetteView>& views) {
    struct Cap {
        Eigen::Vector3d middle;
        double radius_rad = 0.0;
    };
    std::vector<Cap> caps;
    for (const SilhouetteView& view : views) {
        std::vector<Eigen::Vector3d> directions;
        Cap cap{Eigen::Vector3d::Zero(), 0.0};
        for (const Contour& contour : view.contours) {
            for (const Eigen::Vector2d& p : contour) {
                directions.push_back(
                    (view.camera_from_site.rotation.conjugate() * view.intrinsics.ray_camera(p))
                        .normalized());
                cap.middle += directions.back();
            }
        }
        cap.middle.normalize();
        for (const Eigen::Vector3d& direction : directions) {
            const double cosine = std::clamp(direction.dot(cap.middle), -1.0, 1.0);
            cap.radius_rad = std::max(cap.radius_rad, std::acos(cosine));
        }
        for (const Cap& other : caps) {
            const double angle = std::acos(std::clamp(cap.middle.dot(other.middle), -1.0, 1.0));
            if (angle > cap.radius_rad + other.radius_rad + 1e-6) return false;
        }
        caps.push_back(cap);
    }
    return true;
}

// Silhouettes that are consistent and cannot lose a whole body to their resolution.
bool must_have_a_hull(const SceneOptions& options) {
    return (options.bodies == test::BodyKind::kPeople ||
            options.bodies == test::BodyKind::kBalls) &&
           options.segments_per_view >= 50 && options.noise_px == 0.0 && options.shift_px == 0.0 &&
           !options.cropped;
}

// A camera that all others see inside their silhouettes is a vertex with as many faces as its
// outline has edges. All other vertices have three.
bool has_camera_centre(const VisualHull& hull, const std::vector<SilhouetteView>& views) {
    return std::any_of(views.begin(), views.end(), [&](const SilhouetteView& view) {
        const Eigen::Vector3d centre = view.camera_from_site.inverse().translation;
        return std::any_of(hull.mesh.vertices.begin(),
                           hull.mesh.vertices.end(),
                           [&](const Eigen::Vector3d& p) { return (p - centre).norm() < 1e-5; });
    });
}

void expect_sound(const VisualHull& hull, const std::vector<SilhouetteView>& views) {
    const geometry::MeshReport report = geometry::inspect(hull.mesh);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.manifold);
    EXPECT_GT(report.volume_m3, 0.0);
    EXPECT_EQ(report.num_components, hull.num_components);
    EXPECT_TRUE(std::all_of(hull.mesh.vertices.begin(),
                            hull.mesh.vertices.end(),
                            [](const Eigen::Vector3d& p) { return p.allFinite(); }));
    // three faces at every vertex, and the triangulation added no vertex
    if (!has_camera_centre(hull, views)) {
        EXPECT_EQ(hull.mesh.vertices.size() % 2, 0u);
    }
    EXPECT_EQ(
        static_cast<std::int64_t>(hull.mesh.triangles.size()),
        2 * static_cast<std::int64_t>(hull.mesh.vertices.size()) - 2 * report.euler_characteristic);
}

bool have_common_centre(const std::vector<SilhouetteView>& views) {
    for (std::size_t i = 0; i < views.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            const Eigen::Vector3d a = views[i].camera_from_site.inverse().translation;
            const Eigen::Vector3d b = views[k].camera_from_site.inverse().translation;
            if ((a - b).norm() < 1e-6) return true;
        }
    }
    return false;
}

// Allowed volume between the surfaces of two hulls: everywhere the jitter of both, 1e-6 px each in
// x and y, at the depth of the farthest vertex. Cameras at one place are separated by some
// micrometres.
double jitter_volume_m3(const VisualHull& hull,
                        const std::vector<SilhouetteView>& views,
                        std::uint32_t num_attempts) {
    double pixel_m = 0.0;
    for (const SilhouetteView& view : views) {
        for (const Eigen::Vector3d& p : hull.mesh.vertices) {
            pixel_m = std::max(pixel_m,
                               (view.camera_from_site * p).norm() /
                                   std::min(view.intrinsics.fx, view.intrinsics.fy));
        }
    }
    double area_m2 = 0.0;
    for (const auto& [a, b, c] : hull.mesh.triangles) {
        const auto& p = hull.mesh.vertices;
        area_m2 += 0.5 * (p[b] - p[a]).cross(p[c] - p[a]).norm();
    }
    const double jitter_px = 4e-6 * std::pow(10.0, num_attempts - 1.0);
    const double apart_m = have_common_centre(views) ? 1e-5 : 0.0;
    return (jitter_px * pixel_m + apart_m) * area_m2;
}

class Scenes : public testing::TestWithParam<std::uint64_t> {
protected:
    // Calls `check(seed, options, views)` for one scene of every `step`.
    template <typename Check>
    void for_each_scene(std::uint64_t step, const Check& check) {
        for (std::uint64_t i = 0; i < kScenesPerBlock; i += kStride) {
            const std::uint64_t seed = GetParam() * kScenesPerBlock + i;
            if (seed / kStride % step != 0) continue;
            const SceneOptions options = test::random_scene_options(seed);
            SCOPED_TRACE(test::describe(options, seed));
            check(seed, options, test::make_scene(options, seed));
        }
    }
    // Like `for_each_scene`, but only for scenes with a hull.
    template <typename Check>
    void for_some_hulls(const Check& check) {
        for_each_scene(kSubset, [&](std::uint64_t seed, const SceneOptions&, const auto& views) {
            const VisualHull hull = hull_of(views);
            if (hull.status == HullStatus::kOk) check(seed, views, hull);
        });
    }
    VisualHull hull_of(std::span<const SilhouetteView> views) {
        return compute_visual_hull(views, exact(), scratch_);
    }
    HullScratch scratch_;
};

TEST_P(Scenes, HaveASoundHullOrNone) {
    std::map<HullStatus, int> outcomes;
    for_each_scene(1, [&](std::uint64_t, const SceneOptions& options, const auto& views) {
        const VisualHull hull = hull_of(views);
        tally().count(hull);
        ++outcomes[hull.status];
        switch (hull.status) {
            case HullStatus::kOk:
                expect_sound(hull, views);
                break;
            case HullStatus::kEmptyIntersection:
                EXPECT_FALSE(must_have_a_hull(options));
                EXPECT_TRUE(hull.mesh.empty());
                break;
            case HullStatus::kUnbounded:
                EXPECT_TRUE(may_be_unbounded(views));
                EXPECT_TRUE(hull.mesh.empty());
                break;
            default:
                ADD_FAILURE() << to_string(hull.status);
        }
    });
    for (const auto& [status, number] : outcomes) RecordProperty(to_string(status), number);
    EXPECT_GT(outcomes[HullStatus::kOk], outcomes[HullStatus::kEmptyIntersection]);
}

TEST_P(Scenes, CoverNoPixelOutsideAnySilhouette) {
    hull_tool::CoverageScratch coverage_scratch;
    for_some_hulls([&](std::uint64_t, const auto& views, const VisualHull& hull) {
        std::size_t covered_px = 0;
        for (SilhouetteView small : views) {
            // a quarter of the picture's size takes a sixteenth of the time
            constexpr double kScale = 0.25;
            geometry::PinholeCamera& c = small.intrinsics;
            c.width = static_cast<int>(c.width * kScale);
            c.height = static_cast<int>(c.height * kScale);
            for (double* length : {&c.fx, &c.fy, &c.skew}) *length *= kScale;
            for (double* at : {&c.cx, &c.cy}) *at = (*at + 0.5) * kScale - 0.5;
            for (Contour& contour : small.contours) {
                for (Eigen::Vector2d& p : contour)
                    p = (p + Eigen::Vector2d(0.5, 0.5)) * kScale - Eigen::Vector2d(0.5, 0.5);
            }
            const auto coverage = hull_tool::measure_coverage(hull.mesh, small, coverage_scratch);
            EXPECT_EQ(coverage.excess_px, 0u);
            covered_px += coverage.covered_px;
        }
        // otherwise the hull covers no pixel, and the test checks nothing
        if (geometry::volume_m3(hull.mesh) > 1e-3) {
            EXPECT_GT(covered_px, 0u);
        }
    });
}

TEST_P(Scenes, NeverGrowWithOneMoreView) {
    for_some_hulls([&](std::uint64_t, const auto& views, const VisualHull& hull) {
        const VisualHull fewer = hull_of(std::span(views).first(views.size() - 1));
        if (fewer.status == HullStatus::kUnbounded || fewer.status == HullStatus::kTooFewViews)
            return;
        ASSERT_EQ(fewer.status, HullStatus::kOk) << to_string(fewer.status);
        const std::uint32_t num_attempts = std::max(hull.num_attempts, fewer.num_attempts);
        EXPECT_LE(geometry::volume_m3(hull.mesh),
                  geometry::volume_m3(fewer.mesh) + jitter_volume_m3(hull, views, num_attempts));
    });
}

TEST_P(Scenes, DoNotDependOnAnyOrder) {
    for_some_hulls([&](std::uint64_t seed, auto views, const VisualHull& hull) {
        std::mt19937_64 random(seed);
        std::shuffle(views.begin(), views.end(), random);
        for (SilhouetteView& view : views) {
            std::shuffle(view.contours.begin(), view.contours.end(), random);
            for (Contour& contour : view.contours) {
                const auto start = static_cast<std::ptrdiff_t>(random() % contour.size());
                std::rotate(contour.begin(), contour.begin() + start, contour.end());
                if (random() % 2 == 0) std::reverse(contour.begin(), contour.end());
            }
        }
        const VisualHull again = hull_of(views);
        EXPECT_TRUE(hull.mesh.vertices == again.mesh.vertices);
        EXPECT_TRUE(hull.mesh.triangles == again.mesh.triangles);
    });
}

TEST_P(Scenes, DoNotDependOnTheNumberOfWorkers) {
    ThreadPool two(2);
    ThreadPool three(3);
    VisualHull again;
    for_some_hulls([&](std::uint64_t, const auto& views, const VisualHull& hull) {
        for (ThreadPool* pool : {&two, &three}) {
            compute_visual_hull(views, exact(), scratch_, *pool, again);
            EXPECT_TRUE(hull.mesh.vertices == again.mesh.vertices) << pool->num_workers();
            EXPECT_TRUE(hull.mesh.triangles == again.mesh.triangles) << pool->num_workers();
        }
    });
}

TEST_P(Scenes, KeepTheirVolumeWhenTheRigMoves) {
    const geometry::RigidTransform moved_from_site{
        Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, -2.0, 0.5).normalized())),
        {1.0, -3.0, 2.0}};
    for_some_hulls([&](std::uint64_t, auto views, const VisualHull& hull) {
        for (SilhouetteView& view : views)
            view.camera_from_site = view.camera_from_site * moved_from_site.inverse();
        const VisualHull moved = hull_of(views);
        // the parts that the jitter decides may be the whole hull
        const double volume_m3 = geometry::volume_m3(hull.mesh);
        if (moved.status == HullStatus::kEmptyIntersection) {
            EXPECT_LE(volume_m3, jitter_volume_m3(hull, views, hull.num_attempts));
            return;
        }
        ASSERT_EQ(moved.status, HullStatus::kOk) << to_string(moved.status);
        const std::uint32_t num_attempts = std::max(hull.num_attempts, moved.num_attempts);
        EXPECT_NEAR(geometry::volume_m3(moved.mesh),
                    volume_m3,
                    jitter_volume_m3(moved, views, num_attempts));
    });
}

INSTANTIATE_TEST_SUITE_P(Blocks, Scenes, testing::Range(std::uint64_t{0}, kNumBlocks));

}  // namespace
}  // namespace atrium::hull
