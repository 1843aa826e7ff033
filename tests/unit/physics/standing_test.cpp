// Slim things on solid scenery: they stand there as they stand on a box.
#include "tests/unit/physics/things.hpp"
#include "world_server/physics/rigid/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <ostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace atrium::physics {
namespace {

using Random = std::mt19937;

constexpr double kTop_m = 1.0;
constexpr double kHalfTop_m = 2.5;
constexpr int kNumThings = 36;
constexpr double kMostTilt_rad = 10.0 * std::numbers::pi / 180.0;

double between(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

geometry::TriangleMesh block(const Eigen::Vector3d& centre, const Eigen::Vector3d& size_m) {
    return convex_hull(corners_of_box(centre, size_m), kMaxHullVertices);
}

// A flat square that consists of num_x times num_y quadrangles. With `uneven` their corners lie off
// the lattice, their diagonals run either way, and their triangles are wound either way.
geometry::TriangleMesh tiles(int num_x, int num_y, bool uneven) {
    Random random(3);
    const double off = uneven ? 0.3 : 0.0;
    geometry::TriangleMesh mesh;
    for (int j = 0; j <= num_y; ++j) {
        for (int i = 0; i <= num_x; ++i) {
            const bool is_inside_x = i > 0 && i < num_x;
            const bool is_inside_y = j > 0 && j < num_y;
            const double x = i + (is_inside_x ? off * between(random, -1, 1) : 0.0);
            const double y = j + (is_inside_y ? off * between(random, -1, 1) : 0.0);
            mesh.vertices.emplace_back(
                kHalfTop_m * (2 * x / num_x - 1), kHalfTop_m * (2 * y / num_y - 1), kTop_m);
        }
    }
    const auto row = static_cast<std::uint32_t>(num_x + 1);
    for (std::uint32_t a = 0; a + row < mesh.vertices.size(); ++a) {
        if (a % row == row - 1) continue;
        const bool is_other_diagonal = uneven && random() % 2 == 0;
        const std::uint32_t from = is_other_diagonal ? a + 1 : a;
        const std::uint32_t to = is_other_diagonal ? a + row : a + row + 1;
        for (const std::uint32_t third :
             {is_other_diagonal ? a : a + 1, is_other_diagonal ? a + row + 1 : a + row}) {
            if (uneven && random() % 2 == 0)
                mesh.triangles.push_back({from, to, third});
            else
                mesh.triangles.push_back({to, from, third});
        }
    }
    return mesh;
}

struct Ground {
    const char* name;
    geometry::TriangleMesh mesh;  // empty: a fixed box

    void put_into(World& world) const {
        const Eigen::Vector3d size_m(2 * kHalfTop_m, 2 * kHalfTop_m, kTop_m);
        RigidObject table = box_at(1, {0, 0, kTop_m / 2}, size_m);
        table.mass_kg = 0.0;
        if (mesh.empty()) {
            ASSERT_EQ(world.add(table), AddResult::kAdded);
        } else {
            ASSERT_TRUE(world.add_static({.mesh = mesh}));
        }
    }
};

void PrintTo(const Ground& ground, std::ostream* out) { *out << ground.name; }

std::vector<Ground> grounds() {
    return {
        {"Box", {}},
        {"TwelveTriangles", block({0, 0, kTop_m / 2}, {2 * kHalfTop_m, 2 * kHalfTop_m, kTop_m})},
        {"WideTiles", tiles(25, 25, true)},
        {"NarrowTiles", tiles(100, 100, true)},
        {"LongThinTriangles", tiles(1, 250, true)}};
}

RigidObject of_hulls(std::vector<geometry::TriangleMesh> parts) {
    RigidObject object;
    object.shape = parts.size() == 1 ? ObjectShape::kConvex : ObjectShape::kCompound;
    object.size_m = extents_of(parts);
    object.parts = std::make_shared<const std::vector<geometry::TriangleMesh>>(std::move(parts));
    object.mass_kg = 600.0 * volume_m3(object);
    return object;
}

// A foot with `num` corners and points above it.
geometry::TriangleMesh on_a_foot(Random& random, double width_m, double height_m, int num) {
    std::vector<Eigen::Vector3d> points;
    const bool is_frustum = random() % 2 == 0;
    const double top = between(random, 0.4, 1.2);
    for (int i = 0; i < num; ++i) {
        const double angle = 2 * std::numbers::pi * (i + between(random, -0.3, 0.3)) / num;
        const Eigen::Vector3d out(width_m / 2 * std::cos(angle), width_m / 2 * std::sin(angle), 0);
        points.push_back(out - Eigen::Vector3d(0, 0, height_m / 2));
        const double up = is_frustum ? 0.5 : between(random, -0.2, 0.5);
        const double inwards = is_frustum ? top : between(random, 0.2, 0.9);
        points.push_back(inwards * out + Eigen::Vector3d(0, 0, up * height_m));
    }
    points.emplace_back(0, 0, height_m / 2);
    return convex_hull(points, kMaxHullVertices);
}

// A slim thing that stands on z = -height_m / 2.
RigidObject slim_thing(int kind, Random& random, double& height_m) {
    const double width_m = between(random, 0.04, 0.12);
    height_m = width_m * between(random, 1.5, 3.5);
    const Eigen::Vector3d size_m(width_m, width_m, height_m);
    RigidObject thing = box_at(0, {0, 0, 0}, size_m);
    const double leg_m = 0.2 * width_m;
    switch (kind) {
        case 0:
            thing.shape = ObjectShape::kCylinder;
            return thing;
        case 1:
            return thing;
        case 2:
        case 3:
            return of_hulls({on_a_foot(random, width_m, height_m, kind == 2 ? 16 : 7)});
        case 4: {  // on two feet
            const Eigen::Vector3d leg_size(leg_m, width_m, height_m / 2);
            return of_hulls({block({-0.4 * width_m, 0, -height_m / 4}, leg_size),
                             block({0.4 * width_m, 0, -height_m / 4}, leg_size),
                             block({0, 0, height_m / 4}, {width_m, width_m, height_m / 2})});
        }
        default:
            return of_hulls({block({0, 0, 0}, size_m)});
    }
}

class Standing : public testing::TestWithParam<Ground> {};

TEST_P(Standing, SlimThingsStandWhereTheyArePut) {
    int num_different = 0;
    for (const double drop_m : {0.0005, 0.005}) {
        World world({});
        GetParam().put_into(world);
        Random random(static_cast<std::uint32_t>(drop_m * 1e5));
        std::vector<RigidObject> things;
        for (int i = 0; i < kNumThings; ++i) {
            double height_m = 0.0;
            RigidObject thing = slim_thing(i % 6, random, height_m);
            thing.id = 10 + static_cast<std::uint32_t>(i);
            const double x = -2.0 + 0.8 * (i % 6) + between(random, -0.1, 0.1);
            const double y = -2.0 + 0.8 * (i / 6) + between(random, -0.1, 0.1);
            thing.world_from_object = {
                Eigen::Quaterniond(
                    Eigen::AngleAxisd(between(random, 0.0, 6.28), Eigen::Vector3d::UnitZ())),
                {i % 4 == 0 ? 0.8 * (i % 6) - 1.9 : x, y, kTop_m + height_m / 2 + drop_m}};
            ASSERT_EQ(world.add(thing), AddResult::kAdded);
            things.push_back(thing);
        }
        run(world, 10.0);
        for (const RigidObject& thing : things) {
            const RigidState state = state_of(world, thing.id);
            const auto& [rotation, translation] = state.world_from_object;
            const Eigen::Vector3d moved = translation - thing.world_from_object.translation;
            const double upright = (rotation * Eigen::Vector3d::UnitZ()).z();
            SCOPED_TRACE(testing::Message()
                         << "thing " << thing.id << " dropped by " << drop_m << " m");
            EXPECT_GT(upright, std::cos(kMostTilt_rad)) << "fell";
            EXPECT_LT(moved.head<2>().norm(), 0.01) << "slid";
            EXPECT_NEAR(moved.z(), -drop_m, 0.0002) << "does not lie on the surface";
            EXPECT_LT(state.linear_velocity.norm(), 0.002) << "does not come to rest";
            ++num_different;
        }
    }
    EXPECT_EQ(num_different, 2 * kNumThings);
}

TEST_P(Standing, BallsRollAndBoxesSlideOverInnerEdges) {
    for (int i = 0; i < 12; ++i) {
        World world({});
        GetParam().put_into(world);
        RigidObject ball = box_at(2, {-2, -1.99 + 0.1 * i, kTop_m + 0.05}, {0.1, 0.1, 0.1});
        ball.shape = ObjectShape::kSphere;
        RigidObject brick = box_at(3, {-2, 0.51 + 0.1 * i, kTop_m + 0.05}, {0.2, 0.1, 0.1});
        brick.friction = 0.1;
        for (const RigidObject& thing : {ball, brick}) {
            ASSERT_EQ(world.add(thing), AddResult::kAdded);
            ASSERT_TRUE(world.push(thing.id, {2.0 * thing.mass_kg, 0, 0}));
        }
        double highest_m = -1.0;
        for (int tick = 0; tick < 120; ++tick) {
            world.tick();
            for (const RigidObject& thing : {ball, brick})
                highest_m = std::max(highest_m,
                                     state_of(world, thing.id).world_from_object.translation.z());
        }
        EXPECT_LT(highest_m, kTop_m + 0.0505) << "jumps at an edge";
        for (const RigidObject& thing : {ball, brick}) {
            const Eigen::Vector3d way = state_of(world, thing.id).world_from_object.translation -
                                        thing.world_from_object.translation;
            EXPECT_LT(std::abs(way.y()), 0.01) << "turns aside";
            // it rolls at 5/7 of its first speed; it slides against sqrt(0.6 * 0.1)
            EXPECT_GT(way.x(), thing.id == ball.id ? 1.35 : 0.8);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Grounds, Standing, testing::ValuesIn(grounds()), [](const auto& ground) {
    return std::string(ground.param.name);
});

TEST(OnScenery, ACylinderBeyondTheEdgeFalls) {
    for (const double beyond_m : {-0.015, 0.01}) {
        World world({});
        ASSERT_TRUE(world.add_static({.mesh = tiles(20, 20, false)}));
        RigidObject cylinder =
            box_at(2, {kHalfTop_m + beyond_m, 0.1, kTop_m + 0.1}, {0.06, 0.06, 0.2});
        cylinder.shape = ObjectShape::kCylinder;
        ASSERT_EQ(world.add(cylinder), AddResult::kAdded);
        double lowest_m = kTop_m + 0.1;
        for (int tick = 0; tick < 240; ++tick) {
            world.tick();
            lowest_m = std::min(lowest_m, state_of(world, 2).world_from_object.translation.z());
        }
        if (beyond_m < 0.0) {
            EXPECT_NEAR(lowest_m, kTop_m + 0.1, 0.001);
        } else {
            EXPECT_LT(lowest_m, kTop_m);
        }
    }
}

TEST(OnScenery, ABoxInACornerTouchesFloorAndWallsOfOneMesh) {
    World world({});
    geometry::TriangleMesh room = tiles(50, 50, true);
    const auto first = static_cast<std::uint32_t>(room.vertices.size());
    for (const double z : {0.0, 2.0}) {
        for (const auto& [x, y] : {std::pair{-2.0, 2.0}, {-2.0, -2.0}, {2.0, -2.0}})
            room.vertices.emplace_back(x, y, z);
    }
    for (const std::uint32_t a : {first, first + 1}) {
        room.triangles.push_back({a, a + 1, a + 4});
        room.triangles.push_back({a, a + 4, a + 3});
    }
    ASSERT_TRUE(world.add_static({.mesh = room}));
    RigidObject box = box_at(2, {-1.9, -1.9, kTop_m + 0.15}, {0.1, 0.1, 0.3});
    ASSERT_EQ(world.add(box), AddResult::kAdded);
    for (int i = 0; i < 240; ++i) {  // pushed into the corner with three times its weight
        const double impulse = 3.0 * 9.81 * box.mass_kg / 120.0;
        ASSERT_TRUE(world.push(2, {-impulse, -impulse, 0}));
        world.tick();
    }
    const RigidState state = state_of(world, 2);
    const Eigen::Vector3d& at = state.world_from_object.translation;
    EXPECT_NEAR(at.x(), -1.95, 0.002);
    EXPECT_NEAR(at.y(), -1.95, 0.002);
    EXPECT_NEAR(at.z(), kTop_m + 0.15, 0.002);
    EXPECT_GT((state.world_from_object.rotation * Eigen::Vector3d::UnitZ()).z(), 0.999);
}

// At some speeds a thing that is thinner than its way per tick was past the triangles unseen.
TEST(SmallThings, DoNotFallThroughTheFloor) {
    for (const Ground& ground : grounds()) {
        World world({});
        ground.put_into(world);
        std::vector<std::uint32_t> ids;
        for (int i = 0; i < 42; ++i) {
            const double x = 0.1 * (i - 20);
            const double drop_m = 0.1 + 0.04 * i;
            for (const ObjectShape shape :
                 {ObjectShape::kCylinder, ObjectShape::kSphere, ObjectShape::kBox}) {
                RigidObject thing = box_at(static_cast<std::uint32_t>(10 + ids.size()),
                                           {x, 0.3 * static_cast<int>(shape), kTop_m + drop_m},
                                           {0.05, 0.05, 0.03});
                thing.shape = shape;
                if (shape == ObjectShape::kSphere) thing.size_m.setConstant(0.04);
                ASSERT_EQ(world.add(thing), AddResult::kAdded);
                ids.push_back(thing.id);
            }
        }
        for (int tick = 0; tick < 120; ++tick) world.tick();
        for (const std::uint32_t id : ids)
            EXPECT_GT(world.pose_of(id)->translation.z(), kTop_m) << ground.name << ", " << id;
    }
}

}  // namespace
}  // namespace atrium::physics
