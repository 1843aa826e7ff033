#include "simulation/person.hpp"

#include "core/geometry/triangle_mesh.hpp"
#include "tests/support/sanitized.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace atrium::simulation {
namespace {

RoomOptions room(const std::string& look, const std::string& motion) {
    RoomOptions options;
    options.look = look;
    options.motion = motion;
    return options;
}

Person make_person(const RoomOptions& options) {
    auto person = Person::create(options);
    EXPECT_TRUE(person) << person.error().message;
    return *std::move(person);
}

double largest_step_m(const geometry::TriangleMesh& a, const geometry::TriangleMesh& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.vertices.size(); ++i) {
        largest = std::max(largest, (a.vertices[i] - b.vertices[i]).norm());
    }
    return largest;
}

class EveryLook : public testing::TestWithParam<std::string> {};
class EveryMotion : public testing::TestWithParam<std::string> {};

// Sanitized, every third: EveryLook makes them all.
std::vector<std::string> tested_motions() {
    const std::vector<std::string> all = motion_names();
    std::vector<std::string> tested;
    for (std::size_t i = 0; i < all.size(); i += test::kSanitized ? 3 : 1) tested.push_back(all[i]);
    return tested;
}

INSTANTIATE_TEST_SUITE_P(Looks, EveryLook, testing::ValuesIn(look_names()), [](const auto& tested) {
    return tested.param;
});
INSTANTIATE_TEST_SUITE_P(Motions,
                         EveryMotion,
                         testing::ValuesIn(tested_motions()),
                         [](const auto& tested) { return tested.param; });

TEST_P(EveryLook, IsOneClosedManifoldSolidInEveryMotion) {
    const auto times_s =
        test::kSanitized ? std::vector{1.5} : std::vector{0.0, 0.4, 1.1, 1.5, 2.3, 2.9};
    // sanitized, each look makes every fourth motion, and all four together make all
    const std::size_t step = test::kSanitized ? look_names().size() : 1;
    const std::vector<std::string> looks = look_names();
    const auto look = std::ranges::find(looks, GetParam()) - looks.begin();
    const std::vector<std::string> motions = motion_names();
    for (std::size_t i = static_cast<std::size_t>(look) % step; i < motions.size(); i += step) {
        const std::string& motion = motions[i];
        const Person person = make_person(room(GetParam(), motion));
        for (const double time_s : times_s) {
            const geometry::MeshReport report = geometry::inspect(person.mesh(time_s));
            const std::string where = motion + " at " + std::to_string(time_s) + " s";
            EXPECT_TRUE(report.closed) << where;
            EXPECT_TRUE(report.manifold) << where;
            EXPECT_EQ(report.num_components, 1u) << where;
            EXPECT_EQ(report.euler_characteristic, 2) << where;
            // people of this height weigh 45 to 110 kg at about 1 kg per litre; a positive volume
            // is oriented outwards
            EXPECT_GT(report.volume_m3, 0.045) << where;
            EXPECT_LT(report.volume_m3, 0.110) << where;
        }
    }
}

TEST_P(EveryLook, StandsOnTheFloorWithTheHeightOfItsLook) {
    const Person person = make_person(room(GetParam(), "sway"));
    const geometry::Aabb box = geometry::bounds(person.mesh(0.0));
    EXPECT_NEAR(box.min.z(), 0.0, 0.005);
    EXPECT_NEAR(
        box.max.z(), person.look().height_m, 0.05);  // hair above, slightly bent knees below
}

TEST_P(EveryMotion, EndsAtItsStart) {
    const RoomOptions options = room("ben", GetParam());
    const Person person = make_person(options);
    EXPECT_EQ(largest_step_m(person.mesh(0.0), person.mesh(options.loop_s)), 0.0);
    EXPECT_LT(largest_step_m(person.mesh(0.7), person.mesh(0.7 + options.loop_s)), 1e-9);
}

TEST_P(EveryMotion, MovesNoFasterThanPeople) {
    const RoomOptions options = room("ben", GetParam());
    const Person person = make_person(options);
    constexpr double kFastestHandMps = 6.0;
    double furthest_m = 0.0;
    const geometry::TriangleMesh start = person.mesh(0.0);
    geometry::TriangleMesh previous = start;
    for (int frame = 1; frame <= options.num_frames(); ++frame) {
        geometry::TriangleMesh now = person.mesh(options.frame_time_s(frame));
        EXPECT_LT(largest_step_m(previous, now), kFastestHandMps / options.rate_hz)
            << "frame " << frame;
        furthest_m = std::max(furthest_m, largest_step_m(start, now));
        previous = std::move(now);
    }
    EXPECT_GT(furthest_m, 0.10);
}

TEST_P(EveryMotion, KeepsTheFeetOnTheFloor) {
    const RoomOptions options = room("mira", GetParam());
    const Person person = make_person(options);
    for (int frame = 0; frame < options.num_frames(); frame += 3) {
        const double low = geometry::bounds(person.mesh(options.frame_time_s(frame))).min.z();
        EXPECT_GT(low, -0.010) << "frame " << frame;
        EXPECT_LT(low, 0.020) << "frame " << frame;
    }
}

TEST(Person, PushesForwardAtChestHeight) {
    const RoomOptions options = room("ada", "push");
    const Person person = make_person(options);
    Eigen::Vector3d furthest(0.0, 0.0, 0.0);
    double nearest_reach = std::numeric_limits<double>::infinity();
    for (int frame = 0; frame < options.num_frames(); ++frame) {
        const geometry::TriangleMesh mesh = person.mesh(options.frame_time_s(frame));
        const auto tip = std::max_element(
            mesh.vertices.begin(), mesh.vertices.end(), [](const auto& a, const auto& b) {
                return (a.z() > 0.8 ? a.y() : -1.0) < (b.z() > 0.8 ? b.y() : -1.0);
            });
        if (tip->y() > furthest.y()) furthest = *tip;
        nearest_reach = std::min(nearest_reach, tip->y());
    }
    EXPECT_GT(furthest.y(), 0.55);
    EXPECT_GT(furthest.y() - nearest_reach, 0.25);
    EXPECT_NEAR(furthest.z(), 1.2, 0.15);
    EXPECT_GT(furthest.x(), -0.05);  // the right hand
}

TEST(Person, HasItsHandsOverTheTableAndItsBodyBesideIt) {
    const RoomOptions options = room("otto", "table_hands");
    const Person person = make_person(options);
    for (int frame = 0; frame < options.num_frames(); frame += 5) {
        int num_over_table = 0;
        for (const Eigen::Vector3d& p : person.mesh(options.frame_time_s(frame)).vertices) {
            if (p.head<2>().cwiseAbs().maxCoeff() > kTableHalfSideM) continue;
            ++num_over_table;
            EXPECT_GT(p.z(), kTableHeightM) << "frame " << frame;
        }
        EXPECT_GT(num_over_table, 500) << "frame " << frame;
    }
}

TEST(Person, TurnsAndMovesWithItsPlaceInTheRoom) {
    RoomOptions options = room("mira", "wave");
    const geometry::TriangleMesh before = make_person(options).mesh(0.4);
    options.position_m = {0.5, -0.25, 0.1};
    options.heading_rad = 0.8;
    const geometry::TriangleMesh after = make_person(options).mesh(0.4);
    const Eigen::AngleAxisd turn(options.heading_rad, Eigen::Vector3d::UnitZ());
    for (std::size_t i = 0; i < before.vertices.size(); i += 101) {
        EXPECT_LT((after.vertices[i] - (turn * before.vertices[i] + options.position_m)).norm(),
                  1e-9);
    }
}

TEST(Person, NormalsPointOutwards) {
    const Person person = make_person(room("ada", "raise"));
    PosedSkin skin;
    person.pose(1.3, skin);
    const auto of_mesh = geometry::vertex_normals(person.mesh(1.3));
    std::size_t num_agreeing = 0;
    for (std::size_t i = 0; i < of_mesh.size(); ++i)
        num_agreeing += skin.normals[i].dot(of_mesh[i]) > 0.5f;
    EXPECT_GT(num_agreeing, 98 * of_mesh.size() / 100);
}

TEST(RoomOptions, NamesTheWrongOptionAndAllowedValues) {
    const auto message_for = [](auto change) {
        RoomOptions options;
        change(options);
        const auto result = Person::create(options);
        EXPECT_FALSE(result);
        if (result) return std::string();
        EXPECT_EQ(result.error().kind, ErrorKind::kConfiguration);
        return result.error().message;
    };
    using testing::HasSubstr;
    EXPECT_THAT(message_for([](auto& o) { o.look = "zoe"; }),
                testing::AllOf(HasSubstr("simulation.look"), HasSubstr("ada"), HasSubstr("zoe")));
    EXPECT_THAT(message_for([](auto& o) { o.motion = "fly"; }),
                testing::AllOf(HasSubstr("motion"), HasSubstr("push")));
    EXPECT_THAT(message_for([](auto& o) { o.num_people = 5; }),
                HasSubstr("people: must be 1 to 4"));
    EXPECT_THAT(message_for([](auto& o) {
                    o.num_people = 2;
                    o.motion = "table_hands";
                }),
                HasSubstr("for one person"));
    EXPECT_THAT(message_for([](auto& o) { o.rate_hz = 0.0; }), HasSubstr("rate_hz"));
    EXPECT_THAT(message_for([](auto& o) { o.loop_s = std::numeric_limits<double>::quiet_NaN(); }),
                HasSubstr("loop_s"));
    EXPECT_THAT(message_for([](auto& o) { o.noise_lsb = -1.0; }), HasSubstr("noise_lsb"));
    EXPECT_THAT(message_for([](auto& o) { o.num_empty_frames = 0; }),
                HasSubstr("num_empty_frames"));
    EXPECT_THAT(
        message_for([](auto& o) { o.heading_rad = std::numeric_limits<double>::infinity(); }),
        HasSubstr("heading_rad"));
}

}  // namespace
}  // namespace atrium::simulation
