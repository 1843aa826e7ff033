#include "core/config/rig.hpp"
#include "simulation/person.hpp"
#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

namespace atrium::simulation {
namespace {

config::Rig load(const std::string& file) {
    auto rig = config::load_rig(std::string(atrium::test::source_dir() + "/deploy/rigs/") + file);
    EXPECT_TRUE(rig) << rig.error().message;
    return rig ? *std::move(rig) : config::Rig{};
}

bool sees(const geometry::CalibratedCamera& camera, const Eigen::Vector3d& p_site) {
    const Eigen::Vector3d p = camera.camera_from_site * p_site;
    if (p.z() <= 0.0) return false;
    const geometry::PinholeCamera& c = camera.intrinsics;
    const Eigen::Vector2d px = c.distort(c.project(p));
    return px.x() > 0.0 && px.y() > 0.0 && px.x() < c.width - 1.0 && px.y() < c.height - 1.0;
}

TEST(FullBodyRig, SeesATallPersonWithRaisedArmsCompletely) {
    const config::Rig rig = load("full_body.toml");
    ASSERT_EQ(rig.cameras.size(), 8u);
    RoomOptions options;
    options.look = "ben";
    options.motion = "raise";
    const auto person = Person::create(options);
    ASSERT_TRUE(person);
    const double scale = 1.9 / person->look().height_m;
    double highest_m = 0.0;
    for (const double time_s : {0.0, 0.75, 1.5}) {
        for (const Eigen::Vector3d& p : person->mesh(time_s).vertices) {
            highest_m = std::max(highest_m, scale * p.z());
            for (const auto& camera : rig.cameras)
                ASSERT_TRUE(sees(camera, scale * p)) << camera.name << ": " << p.transpose();
        }
    }
    EXPECT_GT(highest_m, 2.2);
}

TEST(FullBodyRig, SeesPeopleWhoStepAsideFromMostSides) {
    const config::Rig rig = load("full_body.toml");
    for (const double x : {-0.7, 0.7}) {
        for (const double y : {-0.7, 0.7}) {
            for (const double z : {0.05, 1.0, 1.9}) {
                int num_seeing = 0;
                for (const auto& camera : rig.cameras) num_seeing += sees(camera, {x, y, z});
                EXPECT_GE(num_seeing, 6) << x << ", " << y << ", " << z;
            }
        }
    }
}

TEST(TableRig, SeesTheSpaceOverTheTableFromAllSides) {
    const config::Rig rig = load("table.toml");
    ASSERT_EQ(rig.cameras.size(), 6u);
    for (const double x : {-0.45, 0.0, 0.45}) {
        for (const double y : {-0.45, 0.0, 0.45}) {
            for (const double z : {0.76, 0.95, 1.15}) {
                int num_seeing = 0;
                for (const auto& camera : rig.cameras) num_seeing += sees(camera, {x, y, z});
                EXPECT_GE(num_seeing, 5) << x << ", " << y << ", " << z;
            }
        }
    }
}

}  // namespace
}  // namespace atrium::simulation
