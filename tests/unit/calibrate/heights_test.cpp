// Up and floor from measured heights, and the up of rigs whose cameras roll.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/conclude_up.hpp"
#include "tools/calibrate/judge/angles.hpp"
#include "tools/calibrate/judge/choose_up.hpp"
#include "tools/calibrate/judge/tape_check.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
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
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kNumRooms = 100;

ForeignRig without_frame() {
    ForeignRig rig;
    rig.format = "a test";
    rig.has_frame = false;
    return rig;
}

void roll(geometry::CalibratedCamera& camera, double degrees) {
    const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ());
    camera.camera_from_site =
        geometry::RigidTransform{Eigen::Quaterniond(turn), Eigen::Vector3d::Zero()} *
        camera.camera_from_site;
}

// A room in any frame, and its up in that.
struct RolledRoom {
    test::Cameras cameras;
    Eigen::Vector3d up;
    std::vector<double> heights_m;  // above the floor
};

// `num_rolled` cameras roll by 5 to 10 degrees more than the 3 of all.
RolledRoom rolled_room(std::uint64_t seed, int num, int num_rolled) {
    atrium::test::Random random(seed);
    RolledRoom room;
    room.cameras = test::random_room(random, num);
    for (int i = 0; i < num_rolled; ++i)
        roll(room.cameras[static_cast<std::size_t>(i)],
             (between(random, 0, 1) == 0 ? 1.0 : -1.0) * between(random, 5.0, 10.0));
    std::ranges::shuffle(room.cameras, random);
    for (const auto& camera : room.cameras) room.heights_m.push_back(camera.centre_site().z());
    const Eigen::Matrix3d any =
        Eigen::AngleAxisd(between(random, 0.0, 3.0),
                          atrium::test::random_in_cube(random, 1.0).normalized())
            .toRotationMatrix();
    room.up = any * Eigen::Vector3d::UnitZ();
    room.cameras = test::in_frame(room.cameras, any);
    return room;
}

// The heights of the first `num` cameras, as measured.
Measurements measure(const RolledRoom& room, std::size_t num, std::uint64_t seed) {
    atrium::test::Random random(seed);
    Measurements measured;
    for (std::size_t i = 0; i < num; ++i)
        measured.heights.push_back({i, room.heights_m[i] + between(random, -0.01, 0.01)});
    return measured;
}

// Of the triangle of the first three cameras, seen from above: its least height.
double width_m(const RolledRoom& room) {
    const auto side = [&](std::size_t i, std::size_t j) {
        const Eigen::Vector3d to = room.cameras[j].centre_site() - room.cameras[i].centre_site();
        return Eigen::Vector3d(to - to.dot(room.up) * room.up);
    };
    const double longest = std::max({side(0, 1).norm(), side(1, 2).norm(), side(0, 2).norm()});
    return side(0, 1).cross(side(0, 2)).norm() / longest;
}

TEST(MeasuredHeights, GiveUpAndFloorWhateverTheCamerasRoll) {
    int num_tried = 0;
    for (std::uint64_t seed = 0; seed < kNumRooms; ++seed) {
        const RolledRoom room = rolled_room(seed, 8, static_cast<int>(seed % 4));
        if (width_m(room) < 1.5) continue;
        ++num_tried;
        const auto measured = measure(room, 3 + seed % 3, seed);
        const UpConclusion result = conclude_up(without_frame(), room.cameras, "", measured);
        ASSERT_TRUE(result.up && result.floor_m) << seed;
        EXPECT_LT(degrees_between(*result.up, room.up), 1.0) << seed;
        EXPECT_NEAR(*result.floor_m, 0.0, 0.02) << seed;
        EXPECT_THAT(result.told, Contains(HasSubstr("up: from the heights of "))) << seed;
        EXPECT_THAT(result.checks, IsEmpty()) << seed;
        EXPECT_THAT(result.problems, IsEmpty()) << seed;
    }
    EXPECT_GT(num_tried, kNumRooms / 3);
}

TEST(MeasuredHeights, OfTwoCamerasGiveOneTilt) {
    for (std::uint64_t seed = 0; seed < kNumRooms; ++seed) {
        const RolledRoom room = rolled_room(seed, 7, 2);
        const auto measured = measure(room, 2, seed);
        const UpConclusion result = conclude_up(without_frame(), room.cameras, "", measured);
        ASSERT_TRUE(result.up && result.floor_m) << seed;
        for (const auto& [camera, metres] : measured.heights) {
            EXPECT_NEAR(
                room.cameras[camera].centre_site().dot(*result.up) - *result.floor_m, metres, 0.02)
                << seed;
        }
        EXPECT_THAT(result.told, Contains(HasSubstr("up: one tilt from the heights of "))) << seed;
        EXPECT_THAT(result.checks,
                    Contains(AllOf(HasSubstr("is taken from the pictures, good to about "),
                                   HasSubstr("as well: --camera-height cam"))))
            << seed;
    }
}

TEST(MeasuredHeights, ThatAreWrongAreNamed) {
    int num_named = 0;
    for (std::uint64_t seed = 0; seed < kNumRooms; ++seed) {
        const RolledRoom room = rolled_room(seed, 8, 1);
        auto measured = measure(room, 6, seed);
        const std::size_t wrong = seed % 6;
        measured.heights[wrong].metres += seed % 2 == 0 ? 0.6 : -0.6;
        const UpConclusion result = conclude_up(without_frame(), room.cameras, "", measured);
        ASSERT_THAT(result.problems, ElementsAre(HasSubstr("contradict each other by up to 0.")))
            << seed;
        const bool is_named =
            result.problems[0].find(fmt::format("again that of {}:", room.cameras[wrong].name)) !=
            std::string::npos;
        num_named += is_named ? 1 : 0;
    }
    EXPECT_GE(num_named, kNumRooms * 9 / 10);
}

TEST(MeasuredHeights, TellThatTheDistanceIsWrong) {
    int num_told = 0;
    for (std::uint64_t seed = 0; seed < kNumRooms; ++seed) {
        RolledRoom room = rolled_room(seed, 8, 0);
        auto measured = measure(room, 7, seed);
        measured.distance = Said::Distance{"cam1", "cam2", 4.0};
        for (auto& camera : room.cameras) camera.camera_from_site.translation *= 1.25;
        const UpConclusion result = conclude_up(without_frame(), room.cameras, "", measured);
        if (result.problems.empty()) continue;
        EXPECT_THAT(result.problems, ElementsAre(HasSubstr("contradict each other or --distance")));
        num_told += result.problems[0].find("with --distance cam1 cam2 3.") != std::string::npos;
    }
    EXPECT_GT(num_told, kNumRooms * 2 / 3);
}

TEST(MeasuredHeights, LeaveAnAxisOfTheFileThatTheyAgreeWith) {
    atrium::test::Random random(3);
    RolledRoom room{test::random_room(random, 6), Eigen::Vector3d::UnitZ(), {}};
    for (const auto& camera : room.cameras) room.heights_m.push_back(camera.centre_site().z());
    auto measured = measure(room, 3, 1);
    const UpConclusion kept = conclude_up({}, room.cameras, "", measured);
    EXPECT_TRUE(kept.is_axis);
    EXPECT_THAT(kept.told, Contains(HasSubstr("cam2 and cam3 agree with it to 1 cm")));
    measured.heights[1].metres += 0.3;
    const UpConclusion turned = conclude_up({}, room.cameras, "", measured);
    EXPECT_FALSE(turned.is_axis);
    const UpConclusion said = conclude_up({}, room.cameras, "+Z", measured);
    EXPECT_TRUE(said.up->isApprox(Eigen::Vector3d::UnitZ()));
    EXPECT_THAT(said.checks, Contains(HasSubstr("contradict it by up to 0.2")));
}

TEST(MeasuredHeights, OnOneLineLeaveATiltToThePictures) {
    RolledRoom room = rolled_room(5, 6, 1);
    // the third camera between the first two
    auto& third = room.cameras[2];
    const Eigen::Vector3d middle =
        0.5 * (room.cameras[0].centre_site() + room.cameras[1].centre_site());
    third.camera_from_site.translation = -(third.camera_from_site.rotation * middle);
    room.heights_m[2] = 0.5 * (room.heights_m[0] + room.heights_m[1]);
    const UpConclusion result = conclude_up(without_frame(), room.cameras, "", measure(room, 3, 5));
    EXPECT_THAT(result.checks,
                ElementsAre(HasSubstr("seen from above, these cameras stand on about one line")));
}

// The horizon of the pictures, without heights.
TEST(RolledCameras, HardlyPullUpAndAreNamed) {
    double off_sum_deg = 0.0;
    double squares_off_sum_deg = 0.0;  // of least squares
    int num_honest = 0;
    int num_named = 0;
    for (std::uint64_t seed = 0; seed < kNumRooms; ++seed) {
        atrium::test::Random random(seed);
        test::Cameras cameras = test::random_room(random, 8);
        roll(cameras[2], 10.0);
        roll(cameras[5], 8.0);
        const UpChoice found = choose_up(cameras);
        const double off_deg = degrees_between(found.up, Eigen::Vector3d::UnitZ());
        Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
        for (const auto& camera : cameras) {
            const Eigen::Vector3d right =
                camera.camera_from_site.rotation.conjugate() * Eigen::Vector3d::UnitX();
            squares += right * right.transpose();
        }
        const Eigen::Vector3d least =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(squares).eigenvectors().col(0);
        off_sum_deg += off_deg;
        squares_off_sum_deg += degrees_between(least.z() < 0.0 ? Eigen::Vector3d(-least) : least,
                                               Eigen::Vector3d::UnitZ());
        num_honest += off_deg <= std::ceil(found.error_deg) ? 1 : 0;
        num_named +=
            std::ranges::any_of(found.rolled, [](const auto& rolled) { return rolled.first == 2; });
    }
    EXPECT_LT(off_sum_deg, 0.8 * squares_off_sum_deg);
    EXPECT_LT(off_sum_deg / kNumRooms, 2.0);
    EXPECT_GE(num_honest, kNumRooms * 9 / 10);
    EXPECT_GE(num_named, kNumRooms * 9 / 10);
}

TEST(RolledCameras, MakeTheStatedErrorLarger) {
    atrium::test::Random random(4);
    test::Cameras cameras = test::random_room(random, 8);
    EXPECT_LT(choose_up(cameras).error_deg, 2.5);
    roll(cameras[1], 8.0);
    roll(cameras[3], -9.0);
    const UpConclusion result = conclude_up(without_frame(), cameras, "");
    EXPECT_THAT(result.checks,
                Contains(AllOf(testing::ContainsRegex("good to about [3-5] degrees"),
                               HasSubstr("cam4 by "),
                               HasSubstr("give --camera-height for each"))));
}

TEST(TapeCheck, NamesCamerasThatWereNotMeasured) {
    const RolledRoom room = rolled_room(1, 5, 0);
    test::Cameras cameras = room.cameras;
    for (std::size_t i = 0; i < 5; ++i) {
        cameras[i].name = fmt::format("c{}", i);
        const Eigen::Vector3d centre(static_cast<double>(i * i), 0.0, 1.0 + 0.1 * i);
        cameras[i].camera_from_site = {Eigen::Quaterniond::Identity(), -centre};
    }
    EXPECT_EQ(tape_check(cameras, {{0}, {{0, 1}}}, true),
              "lengths: so c2 is 1.20 m above the floor, c4 1.40 m, and c2 is 12.00 m from c4: "
              "measure one of them from the lens. If it differs, a camera or a number of "
              "--distance or --camera-height is wrong");
    EXPECT_THAT(tape_check(cameras, {{}, {{2, 4}}}, false),
                AllOf(HasSubstr("so c0 is 9.00 m from c3: measure that from the lens"),
                      HasSubstr("a number of --distance is wrong"),
                      Not(HasSubstr("floor"))));
    EXPECT_THAT(tape_check(cameras, {{0, 1, 2, 3}, std::nullopt}, true),
                HasSubstr("so c4 is 1.40 m above the floor, and c0 is 16.00 m from c4"));
    cameras.resize(2);
    EXPECT_EQ(tape_check(cameras, {{0}, {{0, 1}}}, true), "");
}

}  // namespace
}  // namespace atrium::calibrate
