#include "site_node/refine/phantom_parts.hpp"

#include "site_node/hull/visual_hull.hpp"
#include "site_node/refine/photo_refinement.hpp"
#include "tests/support/shapes/box_mesh.hpp"
#include "tests/support/shapes/scene_maker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

namespace atrium::refine {
namespace {

// To the surface of a limb: the hull of its balls, which are one or two; < 0 inside [m].
double distance_to(const test::ConvexPart& limb, const Eigen::Vector3d& point) {
    constexpr int kNumSteps = 50;
    const test::Sphere& first = limb.balls.front();
    const test::Sphere& last = limb.balls.back();
    double least = 1e9;
    for (int step = 0; step <= kNumSteps; ++step) {
        const double share = static_cast<double>(step) / kNumSteps;
        const Eigen::Vector3d centre = (1.0 - share) * first.centre_site + share * last.centre_site;
        const double radius = (1.0 - share) * first.radius_m + share * last.radius_m;
        least = std::min(least, (point - centre).norm() - radius);
    }
    return least;
}

// A person of limbs in a random pose, and the surfels of the visual hull of eight cameras.
struct Person {
    test::Bodies bodies;
    std::vector<geometry::CalibratedCamera> rig;
    std::vector<PictureView> views;
    geometry::TriangleMesh hull;
    Surfels surfels;

    explicit Person(std::uint64_t seed) {
        std::mt19937_64 random(seed);
        bodies.parts = test::make_person(random, {0.0, 0.0, 0.0});
        const test::SceneOptions options{.segments_per_view = 150};
        rig = test::make_scene_rig(test::RigKind::kRing, options.num_views, bodies, random);
        hull::HullScratch scratch;
        hull = hull::compute_visual_hull(test::views_of(bodies, rig, options, random), {}, scratch)
                   .mesh;
        std::vector<Eigen::Vector3d> centres;
        for (const geometry::CalibratedCamera& camera : rig) {
            centres.push_back(camera.centre_site());
            views.push_back({&camera, {}, nullptr, {}});
        }
        SerialExecutor executor;
        surfels.sample(hull, centres, {}, executor);
    }
    // How far a point lies outside of the person.
    double outside_m(const Eigen::Vector3d& point) const {
        double least = 1e9;
        for (const test::ConvexPart& limb : bodies.parts)
            least = std::min(least, distance_to(limb, point));
        return least;
    }
};

TEST(PhantomParts, AreOutsideOfThePerson) {
    struct {
        double sum_m = 0.0;
        std::size_t num = 0;
        std::size_t num_on_person = 0;
    } unneeded, others;
    PhantomParts parts;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Person person(seed);
        const auto found = parts.find_unneeded(person.surfels, person.views);
        EXPECT_TRUE(std::ranges::is_sorted(found));
        for (std::uint32_t i = 0; i < person.surfels.size(); ++i) {
            auto& of = std::ranges::binary_search(found, i) ? unneeded : others;
            const double outside_m =
                person.outside_m(person.surfels[i].position_site.cast<double>());
            of.sum_m += outside_m;
            of.num_on_person += outside_m < 0.005 ? 1 : 0;
            ++of.num;
        }
    }
    const auto share = [](std::size_t of, std::size_t all) {
        return static_cast<double>(of) / static_cast<double>(all);
    };
    EXPECT_GT(share(unneeded.num, others.num), 0.03);
    EXPECT_GT(unneeded.sum_m / static_cast<double>(unneeded.num),
              4.0 * others.sum_m / static_cast<double>(others.num));
    EXPECT_LT(share(unneeded.num_on_person, unneeded.num), 0.08);
    EXPECT_GT(share(others.num_on_person, others.num), 0.5);
}

// Without the cameras whose outlines they lie on, nothing is known.
TEST(PhantomParts, NeedOutlines) {
    const geometry::TriangleMesh plate = test::box_mesh({0, 0, 0}, {0.6, 0.6, 0.02});
    SerialExecutor executor;
    Surfels surfels;
    surfels.sample(plate, {}, {}, executor);
    PhantomParts parts;
    EXPECT_TRUE(parts.find_unneeded(Surfels(), {}).empty());
    const auto found = parts.find_unneeded(surfels, {});
    EXPECT_GT(found.size(), surfels.size() * 9 / 10);
    EXPECT_TRUE(parts.find_clashing(surfels, std::vector<float>(found.size(), -1.0F)).empty());
}

TEST(PhantomParts, GoWhereTheirSurroundingsClash) {
    const Person person(3);
    PhantomParts parts;
    const auto found = parts.find_unneeded(person.surfels, person.views);
    ASSERT_GT(found.size(), 50U);
    const float limit = PhantomPartsOptions().least_clash;
    std::vector<float> clashes(found.size(), 2.0F * limit);
    EXPECT_EQ(parts.find_clashing(person.surfels, clashes).size(), found.size());
    std::ranges::fill(clashes, 0.5F * limit);
    EXPECT_TRUE(parts.find_clashing(person.surfels, clashes).empty());
    // one that is not seen follows the others, one by itself does not count
    std::ranges::fill(clashes, 1.1F * limit);
    clashes[7] = -1.0F;
    EXPECT_EQ(parts.find_clashing(person.surfels, clashes).size(), found.size());
    std::ranges::fill(clashes, 0.0F);
    clashes[7] = 1.5F * limit;
    EXPECT_LT(parts.find_clashing(person.surfels, clashes).size(), 3U);
}

// Refines the hull with pictures of one colour each, those of every second camera with another one.
geometry::TriangleMesh refined(const Person& person, std::uint8_t every_second) {
    constexpr int kPictureSize = 1000;
    std::array<image::YuvImage, 2> pictures;
    for (std::size_t k = 0; k < 2; ++k) {
        pictures[k] = {image::Plane(kPictureSize, kPictureSize),
                       image::Plane(kPictureSize / 2, kPictureSize / 2),
                       image::Plane(kPictureSize / 2, kPictureSize / 2)};
        std::ranges::fill(pictures[k].u.data, k == 0 ? 100 : every_second);
    }
    image::Mask everywhere(kPictureSize, kPictureSize);
    std::ranges::fill(everywhere.data, 255);
    std::vector<PictureView> views = person.views;
    for (std::size_t i = 0; i < views.size(); ++i) {
        views[i].picture = pictures[i % 2];
        views[i].mask = &everywhere;
        views[i].subject = {0, 0, kPictureSize, kPictureSize};
    }
    geometry::TriangleMesh mesh = person.hull;
    PhotoRefinement refinement;
    SerialExecutor executor;
    EXPECT_TRUE(refinement.refine(mesh, views, executor));
    return mesh;
}

TEST(PhantomParts, ShrinkIfTheCamerasShowDifferentColours) {
    const Person person(3);
    const geometry::TriangleMesh same = refined(person, 100);
    EXPECT_NEAR(geometry::volume_m3(same), geometry::volume_m3(person.hull), 1e-4);
    const geometry::TriangleMesh different = refined(person, 200);
    EXPECT_TRUE(geometry::inspect(different).manifold);
    EXPECT_LT(geometry::volume_m3(different), 0.99 * geometry::volume_m3(person.hull));
    ASSERT_EQ(different.vertices.size(), person.hull.vertices.size());
    std::size_t num_on_person = 0;
    std::size_t num_moved = 0;
    for (std::size_t v = 0; v < different.vertices.size(); ++v) {
        if (person.outside_m(person.hull.vertices[v]) > 0.005) continue;
        ++num_on_person;
        num_moved += (different.vertices[v] - person.hull.vertices[v]).norm() > 0.01 ? 1 : 0;
    }
    EXPECT_LT(static_cast<double>(num_moved), 0.02 * static_cast<double>(num_on_person));
}

}  // namespace
}  // namespace atrium::refine
