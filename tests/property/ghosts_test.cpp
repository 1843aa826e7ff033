#include "site_node/hull/visual_hull.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/scene_maker.hpp"
#include "tests/support/shapes/winding_number.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

// Several people between few cameras, with known bodies: components of the hull that hold nobody
// (ghosts) are dropped, and no body with them.
namespace atrium::hull {
namespace {

using Eigen::Vector3d;

struct Room {
    test::Bodies bodies;
    std::vector<Vector3d> inside;  // points of all bodies
    std::vector<SilhouetteView> views;
};

struct Errors {
    double noise_px = 0.0;  // of each contour point
    double shift_px = 0.0;  // of each silhouette
};

void add_points(const test::ConvexPart& part, std::vector<Vector3d>& points) {
    for (const double share : {0.0, 0.5, 1.0}) {
        points.emplace_back((1.0 - share) * part.balls.front().centre_site +
                            share * part.balls.back().centre_site);
    }
}

// People at least 0.75 m apart, a ball in the air, and a rod beside them.
Room make_room(std::uint64_t seed, int num_people, int num_cameras, const Errors& errors) {
    test::Random random(seed * 1000 + static_cast<std::uint64_t>(10 * num_people + num_cameras));
    Room room;
    std::vector<Vector3d> places;
    while (places.size() < static_cast<std::size_t>(num_people) + 2) {
        const Vector3d place =
            test::between(random, Vector3d(-1.5, -1.5, 0.0), Vector3d(1.5, 1.5, 0.0));
        bool is_free = true;
        for (const Vector3d& other : places) is_free &= (place - other).norm() > 0.75;
        if (is_free) places.push_back(place);
    }
    for (int i = 0; i < num_people; ++i) {
        const auto person = test::make_person(random, places[static_cast<std::size_t>(i)]);
        room.bodies.parts.insert(room.bodies.parts.end(), person.begin(), person.end());
    }
    const Vector3d ball =
        places[places.size() - 1] + Vector3d(0, 0, test::between(random, 0.3, 1.8));
    room.bodies.parts.push_back({{}, {{ball, 0.11}}});
    const Vector3d rod =
        places[places.size() - 2] + Vector3d(0, 0, test::between(random, 0.6, 1.5));
    const Vector3d half = 0.4 * test::random_direction(random);
    room.bodies.parts.push_back({{}, {{rod - half, 0.03}, {rod + half, 0.03}}});
    room.bodies.radius_m = 2.2;
    for (const test::ConvexPart& part : room.bodies.parts) add_points(part, room.inside);
    auto rig = test::make_ring_rig({.num_cameras = num_cameras,
                                    .radius_m = test::between(random, 3.2, 4.5),
                                    .heights_m = {1.3, 2.5},
                                    .first_angle_rad = test::between(random, 0.0, 6.0),
                                    .focal_px = 700.0});
    room.views = views_of(
        room.bodies,
        rig,
        {.segments_per_view = 250, .noise_px = errors.noise_px, .shift_px = errors.shift_px},
        random);
    return room;
}

// The components of a mesh, each with all vertices.
std::vector<geometry::TriangleMesh> components_of(const geometry::TriangleMesh& mesh) {
    std::vector<std::uint32_t> label(mesh.vertices.size());
    for (std::uint32_t v = 0; v < label.size(); ++v) label[v] = v;
    for (bool is_done = false; !is_done;) {
        is_done = true;
        for (const auto& triangle : mesh.triangles) {
            const std::uint32_t least =
                std::min({label[triangle[0]], label[triangle[1]], label[triangle[2]]});
            for (const std::uint32_t v : triangle) {
                is_done &= label[v] == least;
                label[v] = least;
            }
        }
    }
    std::map<std::uint32_t, geometry::TriangleMesh> parts;
    for (const auto& triangle : mesh.triangles) {
        geometry::TriangleMesh& part = parts[label[triangle[0]]];
        part.triangles.push_back(triangle);
    }
    std::vector<geometry::TriangleMesh> result;
    for (auto& [root, part] : parts) {
        part.vertices = mesh.vertices;
        result.push_back(std::move(part));
    }
    return result;
}

struct Tally {
    int num_ghosts = 0;
    double ghost_volume_l = 0.0;
    int num_true = 0;  // points of bodies inside
};

Tally tally(const geometry::TriangleMesh& mesh, const Room& room) {
    Tally result;
    for (const geometry::TriangleMesh& part : components_of(mesh)) {
        int num_inside = 0;
        for (const Vector3d& p : room.inside) num_inside += test::winding_number(part, p) > 0.5;
        result.num_true += num_inside;
        if (num_inside > 0) continue;
        ++result.num_ghosts;
        result.ghost_volume_l += 1000.0 * geometry::volume_m3(part);
    }
    return result;
}

// The hull as it was without a choice by need: all but fragments.
geometry::TriangleMesh all_large(const Room& room, HullScratch& scratch) {
    HullOptions options;
    options.keep_phantoms = true;
    const VisualHull hull = compute_visual_hull(room.views, options, scratch);
    geometry::TriangleMesh large;
    for (const geometry::TriangleMesh& part : components_of(hull.mesh)) {
        if (geometry::volume_m3(part) < options.min_component_volume_m3) continue;
        large.vertices = part.vertices;
        large.triangles.insert(large.triangles.end(), part.triangles.begin(), part.triangles.end());
    }
    return large;
}

class GhostsOf : public testing::TestWithParam<Errors> {};

TEST_P(GhostsOf, SeveralPeopleAreDroppedAndNobodyElse) {
    constexpr std::uint64_t kSeeds = test::kSanitized ? 1 : 2;
    HullScratch scratch;
    Tally before;
    Tally after;
    for (int num_cameras = 4; num_cameras <= 6; ++num_cameras) {
        for (int num_people = 2; num_people <= 4; ++num_people) {
            for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
                const Room room = make_room(seed, num_people, num_cameras, GetParam());
                const Tally all = tally(all_large(room, scratch), room);
                const VisualHull hull = compute_visual_hull(room.views, {}, scratch);
                ASSERT_EQ(hull.status, HullStatus::kOk);
                EXPECT_TRUE(geometry::inspect(hull.mesh).manifold);
                const Tally kept = tally(hull.mesh, room);
                EXPECT_EQ(kept.num_true, all.num_true)
                    << num_cameras << " cameras, " << num_people << " people, seed " << seed;
                before.num_ghosts += all.num_ghosts;
                before.ghost_volume_l += all.ghost_volume_l;
                after.num_ghosts += kept.num_ghosts;
                after.ghost_volume_l += kept.ghost_volume_l;
            }
        }
    }
    RecordProperty("ghosts_before", before.num_ghosts);
    RecordProperty("ghosts_after", after.num_ghosts);
    EXPECT_GT(before.num_ghosts, test::kSanitized ? 50 : 100);
    EXPECT_LE(after.num_ghosts, before.num_ghosts / 30);
    EXPECT_LE(after.ghost_volume_l, 0.1 * before.ghost_volume_l);
}

INSTANTIATE_TEST_SUITE_P(Silhouettes,
                         GhostsOf,
                         testing::Values(Errors{0.0, 0.0}, Errors{1.0, 2.0}),
                         [](const auto& errors) {
                             return errors.param.noise_px > 0.0 ? "WithErrors" : "Exact";
                         });

}  // namespace
}  // namespace atrium::hull
