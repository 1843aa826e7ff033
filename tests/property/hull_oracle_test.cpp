#include "site_node/hull/cones.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/shapes/exact_intersection.hpp"
#include "tests/support/shapes/scene_maker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

// Compares the hull with the exact intersection of the same cones by independent code.
namespace atrium::hull {
namespace {

using test::between;
using test::ExactCone;
using test::ExactSolid;
using test::Random;

// The cones of the last computation, after jitter and rounding. The hull must be exact for these.
std::vector<ExactCone> exact_cones(const HullScratch& scratch) {
    const Cones& cones = intersected_cones(scratch);
    std::vector<ExactCone> result;
    for (const Cones::View& view : cones.views) result.push_back({view.centre, view.axis, {}});
    for (const Cones::Chain& chain : cones.chains) {  // without fields each is a closed contour
        auto& loop = result[cones.strips[chain.first_strip].view].loops.emplace_back();
        for (std::uint32_t s = chain.first_strip; s < chain.last_strip; ++s)
            loop.push_back(cones.ray[cones.strips[s].from]);
    }
    return result;
}

// Planes that differ by jitter only (1e-9 rad) have an ill-conditioned intersection: rounding of
// 1e-16 moves it by a few times 0.1 um along their line.
constexpr double kSamePlace_m = 1e-6;

constexpr std::uint64_t kNumScenes = test::kSanitized ? 15 : 60;

std::vector<SilhouetteView> scene_of_stars(std::uint64_t seed) {
    Random random(seed);
    test::Bodies bodies;
    const int num_views = between(random, 3, 5);
    const auto rig =
        test::make_scene_rig(seed % 2 == 0 ? test::RigKind::kAnywhere : test::RigKind::kOpposite,
                             num_views,
                             bodies,
                             random);
    std::vector<SilhouetteView> views;
    for (const auto& camera : rig)
        views.push_back(test::make_view(camera, test::random_stars(random, 14)));
    return views;
}

std::vector<SilhouetteView> small_scene(std::uint64_t seed) {
    if (seed % 3 == 0) return scene_of_stars(seed);
    Random random(seed);
    test::SceneOptions options;
    options.bodies = static_cast<test::BodyKind>(between(random, 0, 4));
    options.rig = static_cast<test::RigKind>(seed % 7);
    options.num_views = between(random, options.rig == test::RigKind::kSharedCentre ? 3 : 2, 6);
    options.segments_per_view = between(random, 6, 25);
    options.noise_px = between(random, 0, 1) * 1.0;
    options.shift_px = between(random, 0, 3) == 0 ? 20.0 : 0.0;
    return test::make_scene(options, seed);
}

// Returns a depth beyond every vertex of the hull, where the exact cones end. If the hull reached
// farther, the exact solid would be cut.
double far_m(const Cones& cones, const VisualHull& hull) {
    double depth_m = 20.0;
    for (const Cones::View& view : cones.views) {
        const Eigen::Vector3d axis_site = cones.grid_from_site.transpose() * view.axis;
        for (const Eigen::Vector3d& p_site : hull.mesh.vertices)
            depth_m = std::max(depth_m, 2.0 * axis_site.dot(p_site - cones.to_site(view.centre)));
    }
    return depth_m;
}

// A camera that all others see inside their silhouettes is a point of the surface. If its own
// silhouette has several contours, the surface touches itself there.
bool touches_itself(const std::vector<ExactCone>& cones, const ExactSolid& solid) {
    return std::any_of(cones.begin(), cones.end(), [&](const ExactCone& cone) {
        return cone.loops.size() > 1 &&
               std::any_of(solid.vertices.begin(), solid.vertices.end(), [&](const auto& p) {
                   return (p - cone.centre).norm() < 1e-12;
               });
    });
}

class ExactIntersection : public testing::TestWithParam<std::uint64_t> {};

TEST_P(ExactIntersection, EqualsTheHull) {
    const std::vector<SilhouetteView> views = small_scene(GetParam());
    HullOptions options;
    options.keep_phantoms = true;
    HullScratch scratch;
    const VisualHull hull = compute_visual_hull(views, options, scratch);
    const std::vector<ExactCone> cones = exact_cones(scratch);
    if (std::any_of(cones.begin(), cones.end(), [](const auto& c) { return c.loops.empty(); })) {
        EXPECT_EQ(hull.status, HullStatus::kEmptyIntersection);
        return;
    }
    const ExactSolid solid =
        test::intersect_exactly(cones, far_m(intersected_cones(scratch), hull));
    RecordProperty("outcome", to_string(hull.status));
    RecordProperty("exact_vertices", static_cast<int>(solid.vertices.size()));
    if (hull.status == HullStatus::kUnbounded) {
        EXPECT_TRUE(solid.is_cut);
        return;
    }
    EXPECT_FALSE(solid.is_cut);
    if (hull.status == HullStatus::kEmptyIntersection) {
        EXPECT_EQ(solid.num_components, 0u);
        return;
    }
    ASSERT_EQ(hull.status, HullStatus::kOk) << to_string(hull.status);
    const geometry::MeshReport report = geometry::inspect(hull.mesh);
    EXPECT_NEAR(report.volume_m3, solid.volume_m3, 1e-9 * solid.volume_m3);
    EXPECT_EQ(report.num_components, solid.num_components);
    if (touches_itself(cones, solid)) return;
    EXPECT_EQ(hull.mesh.vertices.size(), solid.vertices.size());
    EXPECT_EQ(report.euler_characteristic, solid.euler_characteristic);
    for (const Eigen::Vector3d& p_grid : solid.vertices) {
        const Eigen::Vector3d p = intersected_cones(scratch).to_site(p_grid);
        double nearest_m = std::numeric_limits<double>::infinity();
        for (const Eigen::Vector3d& q : hull.mesh.vertices)
            nearest_m = std::min(nearest_m, (p - q).norm());
        EXPECT_LT(nearest_m, kSamePlace_m) << p.transpose();
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ExactIntersection, testing::Range(std::uint64_t{0}, kNumScenes));

}  // namespace
}  // namespace atrium::hull
