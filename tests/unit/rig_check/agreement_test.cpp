#include "site_node/rig_check/agreement.hpp"

#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/scene_maker.hpp"
#include "tools/visual_hull/coverage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

namespace atrium::rig_check {
namespace {

using test::BodyKind;
using test::RigKind;
using test::SceneOptions;

// The hull's own answer: the share of the silhouettes that its projection covers.
double coverage_by_hull(const std::vector<hull::SilhouetteView>& views) {
    hull::HullOptions options;
    options.keep_phantoms = true;
    hull::HullScratch scratch;
    const hull::VisualHull hull = hull::compute_visual_hull(views, options, scratch);
    hull_tool::CoverageScratch pixels;
    double sum = 0.0;
    for (const hull::SilhouetteView& view : views)
        sum += hull_tool::measure_coverage(hull.mesh, view, pixels).share();
    return sum / static_cast<double>(views.size());
}

TEST(Agreement, IsFullForConsistentSilhouettesOfAnyRig) {
    for (const RigKind rig : {RigKind::kRing,
                              RigKind::kAnywhere,
                              RigKind::kCollinear,
                              RigKind::kOpposite,
                              RigKind::kBehindEachOther,
                              RigKind::kSharedCentre}) {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            SceneOptions options;
            options.rig = rig;
            options.num_views = 3 + static_cast<int>(seed);
            const auto views = test::make_scene(options, seed);
            const Agreement agreement = measure_agreement(views, {});
            EXPECT_GT(agreement.num_rays(), 50u * views.size());
            EXPECT_GT(agreement.share(), 0.97) << test::describe(options, seed);
        }
    }
}

TEST(Agreement, IsTheCoverageOfTheHull) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        SceneOptions options;
        options.rig = seed % 2 == 0 ? RigKind::kRing : RigKind::kAnywhere;
        options.num_views = 6;
        options.shift_px = 4.0 * static_cast<double>(seed);
        const auto views = test::make_scene(options, seed);
        AgreementOptions many;
        many.rays_per_camera = 1000;
        EXPECT_NEAR(measure_agreement(views, many).strict_share(), coverage_by_hull(views), 0.03)
            << test::describe(options, seed);
    }
}

TEST(Agreement, DoesNotDependOnTheUnitOfLength) {
    auto views = test::make_scene({.shift_px = 8.0}, 3);
    const Agreement before = measure_agreement(views, {});
    for (auto& view : views) view.camera_from_site.translation *= 1000.0;
    EXPECT_NEAR(measure_agreement(views, {}).share(), before.share(), 0.005);
}

TEST(Agreement, CountsRaysThatTheBoundsCutByFace) {
    const auto rig = test::make_ring_rig({});
    const test::Sphere sphere{{0.0, 0.0, 0.9}, 0.5};
    const auto views = test::views_of(sphere, rig, 200);
    AgreementOptions options;
    options.bounds = geometry::Aabb{{-1.0, -1.0, 0.6}, {1.0, 1.0, 2.0}};
    const Agreement agreement = measure_agreement(views, options);
    const std::size_t cut = agreement.cut_by_face[4];
    EXPECT_GT(cut, 20u);
    EXPECT_NEAR(agreement.farthest_cut_m[4], 0.42, 0.1);
    for (const std::size_t face : {0u, 1u, 2u, 3u, 5u}) EXPECT_EQ(agreement.cut_by_face[face], 0u);
    // somebody else far outside does not count
    options.bounds = geometry::Aabb{{2.0, 2.0, 0.0}, {3.0, 3.0, 2.0}};
    EXPECT_EQ(measure_agreement(views, options).num_rays(), 0u);
}

TEST(Agreement, NamesTheCameraWhosePictureIsTooSmall) {
    auto rig = test::make_ring_rig({});
    auto views = test::views_of(test::Sphere{{0.0, 0.0, 0.9}, 0.6}, rig, 200);
    // the lower half of one camera's silhouette is outside its picture
    views[2].intrinsics.height = 500;
    for (auto& contour : views[2].contours) {
        for (auto& p : contour) p.y() = std::min(p.y(), 499.5);
    }
    const Agreement agreement = measure_agreement(views, {});
    EXPECT_LT(agreement.strict_share(), 0.8);
    EXPECT_GT(agreement.share(), 0.97);  // the border says nothing about the rig
    for (std::size_t i = 0; i < views.size(); ++i) {
        EXPECT_LE(agreement.cameras[i].contradicted, 5u) << i;  // at the outline's corners
        EXPECT_EQ(agreement.cameras[i].out_of_view > 5, i == 2) << i;
    }
    AgreementOptions partial;
    partial.knows_outside = false;
    EXPECT_GT(measure_agreement(views, partial).share(), 0.97);
}

TEST(Agreement, CamerasWithoutContoursAbstain) {
    auto views = test::make_scene({}, 5);
    views[1].contours.clear();
    const Agreement agreement = measure_agreement(views, {});
    EXPECT_EQ(agreement.cameras[1].rays, 0u);
    EXPECT_GT(agreement.share(), 0.97);
}

}  // namespace
}  // namespace atrium::rig_check
