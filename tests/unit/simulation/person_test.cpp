#include "simulation/person.hpp"

#include "core/geometry/triangle_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

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

TEST(Person, IsOneClosedManifoldSolidInEveryLookAndMotion) {
    for (const std::string& look : look_names()) {
        for (const std::string& motion : motion_names()) {
            const Person person = make_person(room(look, motion));
            for (const double time_s : {0.0, 0.4, 1.1, 1.5, 2.3, 2.9}) {
                const geometry::MeshReport report = geometry::inspect(person.mesh(time_s));
                const std::string where =
                    look + ", " + motion + " at " + std::to_string(time_s) + " s";
                EXPECT_TRUE(report.closed) << where;
                EXPECT_TRUE(report.manifold) << where;
                EXPECT_EQ(report.num_components, 1u) << where;
                EXPECT_EQ(report.euler_characteristic, 2) << where;
                // people of this height weigh 50 to 110 kg at about 1 kg per litre
                EXPECT_GT(report.volume_m3, 0.045) << where;
                EXPECT_LT(report.volume_m3, 0.120) << where;
            }
        }
    }
}

}  // namespace
}  // namespace atrium::simulation
