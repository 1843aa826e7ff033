#include "tests/unit/physics/things.hpp"
#include "world_server/physics/rigid/convex_hull.hpp"

#include <memory>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

namespace atrium::physics {
namespace {

constexpr double kWoodKgM3 = 600.0;
constexpr double kSteelKgM3 = 7800.0;

struct StackKind {
    const char* name;
    double diameter_m;
    double height_m;
    double density_kg_m3 = kWoodKgM3;
    double friction = 0.5;
    double restitution = 0.3;
    double shift_m = 0.0;  // to the left and right by turns
    double tick_s = 1 / 120.0;
};

void PrintTo(const StackKind& kind, std::ostream* out) { *out << kind.name; }

double cylinder_kg(const Eigen::Vector3d& size_m, double density_kg_m3) {
    return density_kg_m3 * std::numbers::pi / 4 * size_m.x() * size_m.y() * size_m.z();
}

RigidObject cylinder_at(std::uint32_t id,
                        const Eigen::Vector3d& position,
                        const Eigen::Vector3d& size_m,
                        double density_kg_m3 = kWoodKgM3) {
    RigidObject cylinder = box_at(id, position, size_m);
    cylinder.shape = ObjectShape::kCylinder;
    cylinder.mass_kg = cylinder_kg(size_m, density_kg_m3);
    return cylinder;
}

std::vector<RigidObject> stack_of(const StackKind& kind, int num_layers) {
    std::vector<RigidObject> stack;
    for (int i = 0; i < num_layers; ++i) {
        RigidObject layer =
            cylinder_at(2 + static_cast<std::uint32_t>(i),
                        {i % 2 == 0 ? -kind.shift_m : kind.shift_m, 0, (0.5 + i) * kind.height_m},
                        {kind.diameter_m, kind.diameter_m, kind.height_m},
                        kind.density_kg_m3);
        layer.friction = kind.friction;
        layer.restitution = kind.restitution;
        stack.push_back(layer);
    }
    return stack;
}

// Largest distance of an object from its start within `seconds`.
double farthest_drift_m(World& world, const std::vector<RigidObject>& objects, double seconds) {
    double farthest = 0.0;
    for (int i = 0; i < static_cast<int>(seconds * 10); ++i) {
        run(world, 0.1);
        for (const RigidObject& object : objects) {
            const Eigen::Vector3d moved = state_of(world, object.id).world_from_object.translation -
                                          object.world_from_object.translation;
            farthest = std::max(farthest, moved.norm());
        }
    }
    return farthest;
}

double drift_on_floor_m(const std::vector<RigidObject>& objects, double tick_s = 1 / 120.0) {
    World world({.tick_s = tick_s});
    world.add(floor_plane());
    for (const RigidObject& object : objects) EXPECT_EQ(world.add(object), AddResult::kAdded);
    return farthest_drift_m(world, objects, 10.0 * (1 / 120.0) / tick_s);
}

std::string name_of(const testing::TestParamInfo<StackKind>& kind) { return kind.param.name; }

class CylinderStack : public testing::TestWithParam<StackKind> {};

TEST_P(CylinderStack, StandsForTenSeconds) {
    for (const int num_layers : {3, 5}) {
        EXPECT_LT(drift_on_floor_m(stack_of(GetParam(), num_layers), GetParam().tick_s), 0.005)
            << num_layers << " layers";
    }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds,
    CylinderStack,
    testing::Values(
        StackKind{"Wood12Cm", 0.12, 0.12},
        StackKind{"Wood6Cm", 0.06, 0.06},
        StackKind{"Wood25Cm", 0.25, 0.25},
        StackKind{"Steel12Cm", 0.12, 0.12, kSteelKgM3},
        StackKind{"Rubber12Cm", 0.12, 0.12, 1100.0, 0.9, 0.8},
        StackKind{"NoBounce12Cm", 0.12, 0.12, kWoodKgM3, 0.9, 0.0},
        StackKind{"FlatDiscs", 0.25, 0.08},
        StackKind{"Tall", 0.08, 0.2},
        StackKind{"Shifted12Cm", 0.12, 0.12, kWoodKgM3, 0.5, 0.3, 0.005},
        StackKind{"ShiftedDiscs", 0.25, 0.08, kWoodKgM3, 0.5, 0.3, 0.02},
        StackKind{.name = "At240Hz", .diameter_m = 0.12, .height_m = 0.12, .tick_s = 1 / 240.0}),
    name_of);

TEST(Stacks, OfCylindersAndBoxesByTurnsStand) {
    std::vector<RigidObject> stack = stack_of({"", 0.12, 0.12}, 5);
    for (const std::size_t i : {0U, 2U, 4U}) stack[i].shape = ObjectShape::kBox;
    EXPECT_LT(drift_on_floor_m(stack), 0.005);
    for (RigidObject& layer : stack) {
        layer.shape = layer.shape == ObjectShape::kBox ? ObjectShape::kCylinder : ObjectShape::kBox;
    }
    EXPECT_LT(drift_on_floor_m(stack), 0.005);
}

TEST(Stacks, OfCylindersOnAHullStand) {
    std::vector<RigidObject> stack = stack_of({"", 0.12, 0.12}, 3);
    RigidObject tray = box_at(9, {0, 0, 0.02}, {0.4, 0.3, 0.04});
    tray.shape = ObjectShape::kConvex;
    tray.parts = std::make_shared<const std::vector<geometry::TriangleMesh>>(std::vector{
        convex_hull(corners_of_box(Eigen::Vector3d::Zero(), tray.size_m), kMaxHullVertices)});
    for (RigidObject& layer : stack)
        layer.world_from_object.translation += Eigen::Vector3d(0.05, 0, 0.04);
    stack.push_back(tray);
    EXPECT_LT(drift_on_floor_m(stack), 0.005);
}

TEST(Stacks, FallWhenTheTopIsBeyondTheEdge) {
    std::vector<RigidObject> stack = stack_of({"", 0.12, 0.12}, 2);
    stack[1].world_from_object.translation.x() = 0.065;
    EXPECT_GT(drift_on_floor_m(stack), 0.05);
    stack = stack_of({"", 0.12, 0.12}, 1);
    const RigidObject table = box_at(9, {0, 0, 0.2}, {0.4, 0.4, 0.4});
    stack[0].world_from_object.translation = {0.21, 0, 0.46};
    stack.push_back(table);
    EXPECT_GT(drift_on_floor_m(stack), 0.3);
}

TEST(Stacks, FallWhenPushedHard) {
    World world({});
    world.add(floor_plane());
    const std::vector<RigidObject> stack = stack_of({"", 0.12, 0.12}, 3);
    for (const RigidObject& layer : stack) world.add(layer);
    run(world, 1.0);
    world.push(4, {0, 1.0, 0});
    EXPECT_GT(farthest_drift_m(world, stack, 3.0), 0.2);
}

TEST(Cylinder, StandsUpAgainAfterASmallTilt) {
    World world({});
    world.add(floor_plane());
    RigidObject cylinder = cylinder_at(2, {0, 0, 0.066}, {0.12, 0.12, 0.12});
    cylinder.world_from_object.rotation =
        Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 0.3, 0).normalized());
    world.add(cylinder);
    run(world, 3.0);
    const RigidState state = state_of(world, 2);
    EXPECT_NEAR(state.world_from_object.translation.z(), 0.06, 0.001);
    EXPECT_GT((state.world_from_object.rotation * Eigen::Vector3d::UnitZ()).z(), 0.99999);
    EXPECT_LT(state.angular_velocity.norm(), 0.01);
}

TEST(Cylinder, RollsOnItsSide) {
    const Eigen::Quaterniond lying(Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitX()));
    for (const bool is_on_box : {false, true}) {
        World world({});
        world.add(floor_plane());
        RigidObject table = box_at(3, {0, 0, 0.2}, {6, 2, 0.4});
        table.mass_kg = 0.0;
        if (is_on_box) world.add(table);
        const double z = is_on_box ? 0.46 : 0.06;
        RigidObject cylinder = cylinder_at(2, {-1, 0, z}, {0.12, 0.12, 0.12});
        cylinder.world_from_object.rotation = lying;
        world.add(cylinder);
        world.push(2, {cylinder.mass_kg, 0, 0});  // 1 m/s
        run(world, 2.0);
        const RigidState state = state_of(world, 2);
        EXPECT_GT(state.world_from_object.translation.x(), -0.2);
        EXPECT_NEAR(state.world_from_object.translation.z(), z, 0.004);
        EXPECT_NEAR(state.angular_velocity.y(), state.linear_velocity.x() / 0.06, 1.0);
    }
}

}  // namespace
}  // namespace atrium::physics
