// How people hold objects. The test sets the velocities of the surfaces instead of estimating them.
#include "tests/support/world/physics_meshes.hpp"
#include "ticks.hpp"
#include "world_server/physics/people/people_field.hpp"
#include "world_server/physics/people/surface_index.hpp"
#include "world_server/physics/world.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>

namespace atrium::physics {
namespace {

using geometry::RigidTransform;
using physics_test::make_box_mesh;

constexpr std::uint32_t kThing = 2;

RigidTransform at(const Eigen::Vector3d& position, double yaw_rad = 0.0) {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), position};
}

// A body of the shape of `mesh` that moves rigidly. It reports the fraction `share` of its
// velocity.
class Holder {
public:
    Holder(const geometry::TriangleMesh& mesh, double share)
        : index_(mesh, SamplingOptions{}), share_(static_cast<float>(share)) {}

    PersonShape shape(const RigidTransform& before, const RigidTransform& now) const {
        PersonShape shape;
        shape.period_s = kMeshPeriodS;
        auto surfels = std::make_shared<std::vector<MovingSurfel>>();
        for (const SurfaceSample& s : index_.samples()) {
            const Eigen::Vector3d p = s.position.cast<double>();
            MovingSurfel surfel;
            surfel.position = (now * p).cast<float>();
            surfel.from = (before * p).cast<float>();
            surfel.normal = (now.rotation * s.normal.cast<double>()).cast<float>();
            surfel.velocity =
                share_ * (surfel.position - surfel.from) / static_cast<float>(kMeshPeriodS);
            surfels->push_back(surfel);
        }
        shape.surfels = surfels;
        return shape;
    }

private:
    SurfaceIndex index_;
    float share_;
};

class HoldTest : public testing::Test {
protected:
    HoldTest() { world.add({.id = 1, .shape = ObjectShape::kPlane, .size_m = {10, 10, 0}}); }

    void add(ObjectShape shape, const Eigen::Vector3d& size_m, const Eigen::Vector3d& position) {
        ASSERT_EQ(world.add({.id = kThing,
                             .shape = shape,
                             .size_m = size_m,
                             .mass_kg = 0.3,
                             .world_from_object = at(position)}),
                  AddResult::kAdded);
    }
    // Plays `pose` of the holder over time. Before time 0 the holder rests at pose(0).
    void play(
        double seconds,
        const Holder& holder,
        const std::function<RigidTransform(double)>& pose,
        const std::function<void()>& look = [] {}) {
        const int num_meshes = static_cast<int>(std::lround(seconds / kMeshPeriodS));
        for (int i = 0; i < num_meshes; ++i) {
            world.set_person(
                "anna",
                holder.shape(pose(std::max(0, i - 1) * kMeshPeriodS), pose(i * kMeshPeriodS)));
            for (int tick = 0; tick < kTicksPerMesh; ++tick) {
                world.tick();
                look();
            }
        }
    }
    RigidState thing() const {
        std::vector<RigidState> states;
        world.get_states(states);
        return states.back();
    }
    Eigen::Vector3d position() const { return thing().world_from_object.translation; }

    World world{WorldOptions{}};
};

// A hand with a thumb, whose surface determines motion in every direction. Its top is at z = 0.
geometry::TriangleMesh make_hand() {
    geometry::TriangleMesh hand = make_box_mesh({0.10, 0.18, 0.03}, at({0, 0, -0.015}), 5);
    append(hand, make_box_mesh({0.03, 0.06, 0.03}, at({0.065, -0.03, -0.015}), 3));
    return hand;
}

double ramp(double t, double from, double seconds) {
    const double s = std::clamp((t - from) / seconds, 0.0, 1.0);
    return s * s * (3.0 - 2.0 * s);
}

TEST_F(HoldTest, CompensatesForUnderestimatedSurfaceVelocity) {
    add(ObjectShape::kBox, {0.08, 0.08, 0.08}, {0, 0, 1.04});
    // as estimated from hulls: 15 cm would be lost over a metre
    const Holder hand(make_hand(), 0.85);
    const auto pose = [](double t) {
        return at({ramp(t, 1.0, 2.5), 0.3 * ramp(t, 1.0, 2.5), 1.0}, 1.2 * ramp(t, 1.0, 2.5));
    };
    play(4.0, hand, pose);
    const Eigen::Vector3d on_hand = pose(4.0).inverse() * position();
    EXPECT_LT(on_hand.head<2>().norm(), 0.02);
    EXPECT_NEAR(on_hand.z(), 0.04, 0.01);
    const Eigen::AngleAxisd turned(pose(4.0).rotation.conjugate() *
                                   thing().world_from_object.rotation);
    EXPECT_LT(turned.angle(), 0.1);
}

TEST_F(HoldTest, LetsObjectsRollOff) {
    add(ObjectShape::kSphere, Eigen::Vector3d::Constant(0.1), {0.0, 0, 1.09});
    const Holder hand(make_hand(), 1.0);
    // after a second the hand tilts by 70 degrees: the object on it must fall
    const auto pose = [](double t) {
        return RigidTransform{Eigen::Quaterniond(Eigen::AngleAxisd(1.2 * ramp(t, 1.0, 0.5),
                                                                   Eigen::Vector3d::UnitY())),
                              {0, 0, 1.0}};
    };
    play(0.9, hand, pose);
    EXPECT_GT(position().z(), 1.0);
    play(3.0, hand, [&](double t) { return pose(t + 0.9); });
    EXPECT_LT(position().z(), 0.2);
}

TEST_F(HoldTest, ObjectDeepInAThinHandIsNotPushedOutOfItsBack) {
    // more than half of the hand's thickness of 3 cm, as between palms that press
    add(ObjectShape::kBox, {0.06, 0.06, 0.06}, {0, 0, 1.0 + 0.03 - 0.02});
    const Holder hand(make_hand(), 1.0);
    double lowest = 2.0;
    play(
        1.0,
        hand,
        [](double) {
            return at({0, 0, 1.0});
        },
        [&] { lowest = std::min(lowest, position().z()); });
    EXPECT_GT(lowest, 1.005);
    EXPECT_NEAR(position().z(), 1.03, 0.005);
}

TEST_F(HoldTest, ObjectBetweenContradictorySurfacesStaysStill) {
    add(ObjectShape::kSphere, Eigen::Vector3d::Constant(0.12), {0, 0, 1.0});
    // walls that overlap it by 1 cm on either side, slanted by 10 degrees against each other
    geometry::TriangleMesh walls;
    for (const double side : {-1.0, 1.0}) {
        const Eigen::Quaterniond slant(Eigen::AngleAxisd(side * 0.09, Eigen::Vector3d::UnitZ()));
        append(walls, make_box_mesh({0.04, 0.16, 0.16}, {slant, {side * 0.07, 0, 0}}, 6));
    }
    const Holder palms(walls, 1.0);
    double fastest_mps = 0.0;
    int num_ticks = 0;
    play(
        2.0,
        palms,
        [](double) {
            return at({0, 0, 1.0});
        },
        [&] {
            if (++num_ticks > 60)
                fastest_mps = std::max(fastest_mps, thing().linear_velocity.norm());
        });
    EXPECT_LT(fastest_mps, 0.02);
    EXPECT_LT((position() - Eigen::Vector3d(0, 0, 1.0)).norm(), 0.03);
}

TEST_F(HoldTest, HeldObjectTurnsWithTheHands) {
    add(ObjectShape::kSphere, Eigen::Vector3d::Constant(0.12), {0, 0, 1.0});
    geometry::TriangleMesh walls;
    for (const double side : {-1.0, 1.0})
        append(walls, make_box_mesh({0.04, 0.12, 0.16}, at({side * 0.07, 0, 0}), 6));
    const Holder palms(walls, 1.0);
    const auto pose = [](double t) {
        return at({0, 0, 1.0}, 0.5 * std::numbers::pi * ramp(t, 0.5, 2.0));
    };
    play(3.0, palms, pose);
    const Eigen::AngleAxisd behind(pose(3.0).rotation.conjugate() *
                                   thing().world_from_object.rotation);
    EXPECT_LT(behind.angle(), 0.15);
}

// `query` must find nothing where `may_find` returns false.
TEST(PersonField, RulesOutOnlyPlacesWithoutASurface) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    const auto any = [&] { return Eigen::Vector3f(unit(random), unit(random), unit(random)); };
    std::size_t num_found = 0;
    std::size_t num_ruled_out = 0;
    for (int scene = 0; scene < 20; ++scene) {
        PersonShape shape;
        auto surfels = std::make_shared<std::vector<MovingSurfel>>();
        for (int i = 0; i < 400; ++i) {
            const Eigen::Vector3f outwards = any().normalized();
            const Eigen::Vector3f place = 0.15F * outwards + 0.02F * any();
            const Eigen::Vector3f normal = (outwards + 0.3F * any()).normalized();
            surfels->push_back({place, normal, place, Eigen::Vector3f::Zero()});
        }
        shape.surfels = surfels;
        PersonField field;
        field.set_shape(shape);
        field.begin_tick(kTickS);
        for (int i = 0; i < 2000; ++i) {
            const Eigen::Vector3f point = 0.3F * any();
            const SurfaceProbe probe{Eigen::Vector3f::Zero(), any().normalized()};
            const bool finds = field.query(point, probe).has_value();
            num_found += finds ? 1 : 0;
            if (field.may_find(point, probe)) continue;
            ++num_ruled_out;
            EXPECT_FALSE(finds);
        }
    }
    EXPECT_GT(num_found, 1000U);
    EXPECT_GT(num_ruled_out, 1000U);
}

}  // namespace
}  // namespace atrium::physics
