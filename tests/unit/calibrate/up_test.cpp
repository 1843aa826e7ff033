// Up of rigs in which some cameras stand on their side, hang upside down, or look straight down.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/conclude_up.hpp"
#include "tools/calibrate/judge/choose_up.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::calibrate {
namespace {

using atrium::test::between;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr int kSeeds = 60;

void turn_picture(geometry::CalibratedCamera& camera, double degrees) {
    const geometry::RigidTransform turn{
        Eigen::Quaterniond(Eigen::AngleAxisd(degrees * kDeg, Eigen::Vector3d::UnitZ())),
        Eigen::Vector3d::Zero()};
    camera.camera_from_site = turn * camera.camera_from_site;
}

// Cameras around a room, `num_turned` of them on either side, each tilted by up to `tilt_deg` more.
test::Cameras turned_room(atrium::test::Random& random, int num, int num_turned, double tilt_deg) {
    test::Cameras cameras = test::random_room(random, num);
    for (int i = 0; i < num; ++i) {
        auto& camera = cameras[static_cast<std::size_t>(i)];
        turn_picture(camera, between(random, -tilt_deg, tilt_deg));
        if (i < num_turned) turn_picture(camera, between(random, 0, 1) == 0 ? 90.0 : -90.0);
    }
    std::ranges::shuffle(cameras, random);
    return cameras;
}

double degrees_off(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) / kDeg;
}

ForeignRig colmap_like() {
    ForeignRig rig;
    rig.format = "a test";
    rig.has_frame = false;
    return rig;
}

struct Mix {
    int num;
    int num_turned;
};

class TurnedCameras : public testing::TestWithParam<Mix> {};

TEST_P(TurnedCameras, AreOutvotedOrDoubted) {
    int num_right = 0;
    for (int seed = 0; seed < kSeeds; ++seed) {
        atrium::test::Random random(static_cast<std::uint64_t>(100 * seed + GetParam().num));
        const auto room = turned_room(random, GetParam().num, GetParam().num_turned, 3.0);
        const Eigen::Matrix3d any =
            Eigen::AngleAxisd(between(random, 0.0, 3.0),
                              atrium::test::random_in_cube(random, 1.0).normalized())
                .toRotationMatrix();
        const Eigen::Vector3d up = any * Eigen::Vector3d::UnitZ();
        const auto cameras = test::in_frame(room, any);
        const UpChoice found = choose_up(cameras);
        const double off_deg = degrees_off(found.up, up);
        if (off_deg < 6.0 && found.is_known) {
            ++num_right;
            EXPECT_EQ(found.on_side.size(), static_cast<std::size_t>(GetParam().num_turned))
                << seed;
            continue;
        }
        // else it is an alternative, and both are ready to be said
        ASSERT_TRUE(found.rival) << "seed " << seed << " off " << off_deg;
        EXPECT_LT(degrees_off(found.rival->up, up), 6.0) << "seed " << seed;
        EXPECT_THAT(conclude_up(colmap_like(), cameras, "").checks,
                    Contains(HasSubstr("two directions are about as likely: --up")))
            << seed;
    }
    EXPECT_GE(num_right, kSeeds * 9 / 10);
}

// The pictures that are turned do not look like a sign of another meaning of the poses.
TEST_P(TurnedCameras, LeaveTheDocumentedMeaning) {
    int kept = 0;
    for (int seed = 0; seed < kSeeds; ++seed) {
        atrium::test::Random random(static_cast<std::uint64_t>(900 + 100 * seed));
        const auto cameras = turned_room(random, GetParam().num, GetParam().num_turned, 3.0);
        std::vector<ForeignPose> poses;
        const Reading& truth = kReadings[static_cast<std::size_t>(seed) % kReadings.size()];
        for (const auto& camera : cameras)
            poses.push_back(foreign_pose(camera.camera_from_site, truth));
        kept += choose_reading(cameras, poses, truth).is_documented ? 1 : 0;
    }
    EXPECT_EQ(kept, kSeeds);
}

INSTANTIATE_TEST_SUITE_P(Mixes,
                         TurnedCameras,
                         testing::Values(Mix{4, 0},
                                         Mix{8, 0},
                                         Mix{5, 1},
                                         Mix{6, 1},
                                         Mix{7, 1},
                                         Mix{8, 1},
                                         Mix{7, 2},
                                         Mix{8, 3},
                                         Mix{16, 1},
                                         Mix{16, 4},
                                         Mix{32, 1}),
                         [](const auto& mix) {
                             return fmt::format("{}of{}", mix.param.num_turned, mix.param.num);
                         });

TEST(TurnedCamerasTold, AreNamedAndTheSaidUpIsNoProblem) {
    atrium::test::Random random(5);
    auto cameras = test::random_room(random, 8);
    turn_picture(cameras[2], 90.0);
    turn_picture(cameras[5], 180.0);
    for (const std::string said : {"", "+Z"}) {
        ForeignRig foreign;
        foreign.up = "+Z";
        const UpConclusion result = conclude_up(foreign, cameras, said);
        EXPECT_THAT(result.problems, IsEmpty()) << said;
        EXPECT_THAT(result.checks, IsEmpty()) << said;
        EXPECT_THAT(
            result.told,
            AllOf(Contains(HasSubstr("up: +Z, as ")),
                  Contains("up: camera 'cam3' stands on its side: its pictures are turned "
                           "by 90 degrees"),
                  Contains(HasSubstr("up: camera 'cam6' hangs upside down: its pictures are "
                                     "turned by 180 degrees; if they show the room "
                                     "upright, turn them back"))));
    }
    EXPECT_THAT(conclude_up({}, cameras, "+X").problems, Contains(HasSubstr("say --up +Z")));
}

TEST(TurnedCamerasTold, EqualVotesAreADoubtWithBothDirections) {
    // on an arc of 100 degrees in one height, without tilt: either half may be the one on its side
    test::Cameras cameras;
    for (int i = 0; i < 8; ++i) {
        const double angle = (100.0 * i / 7 - 50.0) * kDeg;
        const Eigen::Vector3d eye(4.0 * std::cos(angle), 4.0 * std::sin(angle), 1.0);
        const Eigen::Vector3d forwards = (Eigen::Vector3d(0, 0, 1) - eye).normalized();
        const Eigen::Vector3d right = forwards.cross(Eigen::Vector3d::UnitZ());
        Eigen::Matrix3d rotation;
        rotation << right.transpose(), forwards.cross(right).transpose(), forwards.transpose();
        cameras.push_back(
            {fmt::format("cam{}", i + 1), {}, {Eigen::Quaterniond(rotation), -(rotation * eye)}});
        if (i % 2 == 0) turn_picture(cameras.back(), 90.0);
    }
    const UpConclusion result = conclude_up(colmap_like(), cameras, "");
    EXPECT_THAT(result.checks,
                Contains(AllOf(HasSubstr("--up +Z, along which 4 of 8 cameras are level, 4 on"),
                               HasSubstr("two directions are about as likely"))));
    EXPECT_THAT(conclude_up(colmap_like(), cameras, "+Z").problems, IsEmpty());
}

TEST(CamerasThatLookDown, AgreeWithTheLevelOnesWhateverTheirRoll) {
    for (int seed = 0; seed < kSeeds; ++seed) {
        atrium::test::Random random(static_cast<std::uint64_t>(7000 + seed));
        auto cameras = test::random_room(random, between(random, 4, 8));
        for (int i = between(random, 1, 2); i > 0; --i) {
            const Eigen::Vector3d eye =
                Eigen::Vector3d(0, 0, 3.2) + atrium::test::random_in_cube(random, 0.4);
            const Eigen::Vector3d forwards = (Eigen::Vector3d(0, 0, 0.9) - eye).normalized();
            const Eigen::Quaterniond rotation =
                Eigen::AngleAxisd(between(random, -3.0, 3.0), Eigen::Vector3d::UnitZ()) *
                Eigen::Quaterniond::FromTwoVectors(forwards, Eigen::Vector3d::UnitZ());
            cameras.push_back({fmt::format("top{}", i), {}, {rotation, -(rotation * eye)}});
        }
        const UpChoice found = choose_up(cameras);
        EXPECT_TRUE(found.is_known) << seed;
        EXPECT_FALSE(found.rival) << seed;
        EXPECT_LT(degrees_off(found.up, Eigen::Vector3d::UnitZ()), 5.0) << seed;
        EXPECT_EQ(found.num_level, cameras.size()) << seed;
    }
}

}  // namespace
}  // namespace atrium::calibrate
