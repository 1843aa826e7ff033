#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"
#include "tools/calibrate/picture_size.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace atrium::calibrate {
namespace {

constexpr int kRigs = 50;

Eigen::Matrix3d frame_with_up(const std::string& up) {
    return upright_from(axis_vector(up)).toRotationMatrix().transpose();
}

ForeignRig foreign_of(const test::Cameras& cameras, const Reading& truth, double units_per_m) {
    ForeignRig rig;
    rig.format = "a test";
    for (const auto& camera : cameras) {
        ForeignPose pose = foreign_pose(camera.camera_from_site, truth);
        pose.vector *= units_per_m;
        rig.cameras.push_back({camera.name, camera.intrinsics, true, pose});
    }
    return rig;
}

// Heights and distances say unit, up and meaning of the poses; the turn about up is free.
bool is_same_room(const test::Cameras& a, const test::Cameras& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        const std::size_t j = (i + 1) % a.size();
        const Eigen::Vector3d p = a[i].centre_site();
        const Eigen::Vector3d q = b[i].centre_site();
        const double apart = (p - a[j].centre_site()).norm();
        if (std::abs(p.z() - q.z()) > 1e-6) return false;
        if (std::abs(apart - (q - b[j].centre_site()).norm()) > 1e-6) return false;
        // the axis, too, so that no mirrored rig passes
        const auto axis_z = [](const geometry::CalibratedCamera& camera) {
            return (camera.camera_from_site.rotation.conjugate() * Eigen::Vector3d::UnitZ()).z();
        };
        if (std::abs(axis_z(a[i]) - axis_z(b[i])) > 1e-6) return false;
    }
    return true;
}

TEST(Judge, FindsMeaningUnitAndUpOfEveryRoom) {
    const std::vector<std::string> ups{"+Z", "+Y", "-Y", "-Z", "+X"};
    for (std::uint64_t seed = 0; seed < kRigs; ++seed) {
        atrium::test::Random random(seed);
        const auto truth = test::random_room(random, atrium::test::between(random, 4, 12));
        const auto& up = ups[seed % ups.size()];
        const Reading reading = kReadings[seed % kReadings.size()];
        const double units_per_m = std::vector{1.0, 100.0, 1000.0}[seed % 3];
        const auto foreign =
            foreign_of(test::in_frame(truth, frame_with_up(up)), reading, units_per_m);
        const auto result = conclude(foreign, {});
        ASSERT_TRUE(result) << seed << ": " << result.error().message;
        EXPECT_TRUE(is_same_room(result->rig.cameras, truth))
            << "seed " << seed << " up " << up << " units " << units_per_m << ": "
            << testing::PrintToString(result->told);
    }
}

// Whatever a format documents is kept where it fits the cameras.
TEST(Judge, KeepsTheDocumentedMeaningOfEveryRoom) {
    for (std::uint64_t seed = 0; seed < kRigs; ++seed) {
        atrium::test::Random random(1000 + seed);
        const auto truth = test::random_room(random, atrium::test::between(random, 2, 12));
        const Reading reading = kReadings[seed % kReadings.size()];
        ForeignRig foreign = foreign_of(truth, reading, 1000.0);
        foreign.documented = reading;
        foreign.units = "mm";
        foreign.up = "+Z";
        const auto result = conclude(foreign, {});
        ASSERT_TRUE(result) << seed << ": " << result.error().message;
        EXPECT_TRUE(is_same_room(result->rig.cameras, truth)) << "seed " << seed;
    }
}

// A chain of cameras has the frame of the first one: its up is between the axes.
TEST(Judge, FindsUpAndFloorInTheFrameOfACamera) {
    for (std::uint64_t seed = 0; seed < kRigs; ++seed) {
        atrium::test::Random random(2000 + seed);
        const auto truth = test::random_room(random, atrium::test::between(random, 4, 12));
        test::Cameras chain = truth;
        for (auto& camera : chain)
            camera.camera_from_site = camera.camera_from_site * truth[0].camera_from_site.inverse();
        ForeignRig foreign = foreign_of(chain, {}, 1.0);
        foreign.has_frame = false;
        foreign.is_sure_of_poses = true;
        Said said;
        said.heights = {{truth[1].name, truth[1].centre_site().z()}};
        const auto result = conclude(foreign, said);
        ASSERT_TRUE(result) << seed << ": " << result.error().message;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            // each picture is tilted by up to 3 degrees
            EXPECT_NEAR(result->rig.cameras[i].centre_site().z(), truth[i].centre_site().z(), 0.35)
                << "seed " << seed;
        }
    }
}

// Cameras on their side, as for standing people, still tell up.
TEST(Judge, FindsUpOfPortraitPictures) {
    int num_right = 0;
    for (std::uint64_t seed = 0; seed < kRigs; ++seed) {
        atrium::test::Random random(3000 + seed);
        auto truth = test::random_room(random, atrium::test::between(random, 5, 12));
        const geometry::RigidTransform on_its_side{
            Eigen::Quaterniond(Eigen::AngleAxisd(1.5708, Eigen::Vector3d::UnitZ())),
            Eigen::Vector3d::Zero()};
        for (auto& camera : truth) camera.camera_from_site = on_its_side * camera.camera_from_site;
        const auto result =
            conclude(foreign_of(test::in_frame(truth, frame_with_up("-Y")), {}, 1.0), {});
        ASSERT_TRUE(result);
        const bool is_right = is_same_room(result->rig.cameras, truth);
        num_right += is_right ? 1 : 0;
        // where it errs, it says that it does not know
        if (!is_right) {
            EXPECT_THAT(result->checks, testing::Contains(testing::HasSubstr("--up"))) << seed;
        }
    }
    EXPECT_GT(num_right, kRigs / 3);
}

TEST(Judge, SaysWhatItCannotKnow) {
    atrium::test::Random random(7);
    const auto truth = test::random_room(random, 5);
    // lengths in squares of a board of 3 cm
    const auto squares = conclude(foreign_of(truth, {}, 33.3), {});
    ASSERT_TRUE(squares);
    EXPECT_THAT(squares->told, testing::Contains(testing::HasSubstr("lengths: cm")));
    EXPECT_THAT(squares->checks,
                testing::Contains(testing::AllOf(
                    testing::HasSubstr("is small for a person; if lengths are squares"),
                    testing::HasSubstr("--distance cam1 cam2 METRES"))));
    const auto documented = [&] {
        ForeignRig rig = foreign_of(truth, {}, 33.3);
        rig.units = "cm";
        return conclude(rig, {});
    }();
    ASSERT_TRUE(documented);
    EXPECT_THAT(documented->checks,
                testing::Not(testing::Contains(testing::HasSubstr("squares of a chessboard"))));
    const auto absurd = conclude(foreign_of(truth, {}, 1e-3), {});
    ASSERT_FALSE(absurd);
    EXPECT_THAT(absurd.error().message, testing::HasSubstr("--distance cam1 cam2"));
    Said said;
    said.distance = Said::Distance{"cam1", "nobody", 2.0};
    const auto unknown = conclude(foreign_of(truth, {}, 1.0), said);
    ASSERT_FALSE(unknown);
    EXPECT_THAT(unknown.error().message, testing::HasSubstr("'nobody'"));
}

TEST(Judge, DoubtsAMeasuredDistanceThatMakesNoRoom) {
    atrium::test::Random random(9);
    const auto truth = test::random_room(random, 6);
    const double apart_m = (truth[0].centre_site() - truth[1].centre_site()).norm();
    const auto problems_of = [&](double said_m) {
        Said said;
        said.distance = Said::Distance{"cam1", "cam2", said_m};
        const auto result = conclude(foreign_of(truth, {}, 7.0), said);
        EXPECT_TRUE(result);
        std::string text;
        for (const std::string& problem : result->problems) text += problem;
        return text;
    };
    EXPECT_THAT(problems_of(apart_m), testing::Not(testing::HasSubstr("lengths")));
    EXPECT_THAT(problems_of(100.0 * apart_m),
                testing::HasSubstr(
                    fmt::format("if you gave cm, say --distance cam1 cam2 {:.4g}; else", apart_m)));
    EXPECT_THAT(problems_of(0.1 * apart_m), testing::HasSubstr("if the room is not that small"));
}

// 0.8 to 1.5 m is a usual distance for a face, but not for a person.
TEST(Judge, DoubtsAMeasuredDistanceThatMakesPeopleSmall) {
    EXPECT_THAT(doubt_small_measured(1.6, "cam1", "cam2"), testing::IsEmpty());
    EXPECT_THAT(doubt_small_measured(1.3, "cam1", "cam2"),
                testing::AllOf(testing::HasSubstr("lengths: 1.3 m from the cameras"),
                               testing::HasSubstr("is small for a person"),
                               testing::HasSubstr("--distance cam1 cam2 METRES")));
    atrium::test::Random random(12);
    const auto truth = test::random_room(random, 5);
    Said said;
    const double stand_m = measure_convergence(truth).median_distance;
    const double apart_m = (truth[0].centre_site() - truth[1].centre_site()).norm();
    for (const auto& [metres, is_small] : {std::pair(1.2, true), {3.0, false}}) {
        said.distance = {truth[0].name, truth[1].name, apart_m * metres / stand_m};
        const auto result = conclude(foreign_of(truth, {}, 1000.0), said);
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_THAT(result->problems, testing::IsEmpty());
        EXPECT_EQ(std::ranges::any_of(result->checks,
                                      [](const std::string& check) {
                                          return check.find("small for a person") !=
                                                 std::string::npos;
                                      }),
                  is_small);
    }
}

// The room is 1.6 to 5 m around its middle: a factor of 10 is unusual, and the right unit is named.
TEST(Judge, NamesTheUnitThatWouldMakeARoom) {
    for (std::uint64_t seed = 0; seed < kRigs; ++seed) {
        atrium::test::Random random(4000 + seed);
        const auto truth = test::random_room(random, atrium::test::between(random, 4, 12));
        Said said;
        said.units = "cm";
        const auto wrong = conclude(foreign_of(truth, {}, 1000.0), said);
        ASSERT_TRUE(wrong);
        EXPECT_THAT(wrong->problems,
                    testing::Contains(testing::AllOf(testing::HasSubstr("as mm it would be"),
                                                     testing::HasSubstr("--units mm"))))
            << seed;
        said.units = "mm";
        const auto right = conclude(foreign_of(truth, {}, 1000.0), said);
        ASSERT_TRUE(right);
        EXPECT_THAT(right->problems, testing::IsEmpty()) << seed;
        // found out, it is not worth a word
        const auto found = conclude(foreign_of(truth, {}, 1000.0), {});
        ASSERT_TRUE(found);
        EXPECT_THAT(found->checks, testing::Not(testing::Contains(testing::HasSubstr("lengths"))))
            << seed;
    }
}

TEST(Judge, WritesLengthsWithoutExponents) {
    EXPECT_EQ(length_text(4412.7), "4410");
    EXPECT_EQ(length_text(1.23456e6), "1230000");
    EXPECT_EQ(length_text(3.914), "3.91");
    EXPECT_EQ(length_text(441.27), "441");
    EXPECT_EQ(length_text(4.41e-5), "0.0000441");
}

TEST(Judge, KnowsInchesAndFeetIfTheUserSaysSo) {
    atrium::test::Random random(8);
    const auto truth = test::random_room(random, 5);
    Said said;
    for (const auto& [unit, per_m] :
         {std::pair("in", 1.0 / 0.0254), std::pair("ft", 1.0 / 0.3048)}) {
        said.units = unit;
        const auto result = conclude(foreign_of(truth, {}, per_m), said);
        ASSERT_TRUE(result);
        EXPECT_TRUE(is_same_room(result->rig.cameras, truth)) << unit;
    }
}

TEST(Judge, TurnsEveryAxisUp) {
    for (const char* name : {"+X", "-X", "+Y", "-Y", "+Z", "-Z", "Y"}) {
        const Eigen::Vector3d up = axis_vector(name);
        EXPECT_NEAR((upright_from(up) * up - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-12) << name;
    }
    EXPECT_TRUE(axis_vector("up").isZero());
    EXPECT_TRUE(axis_vector("").isZero());
}

TEST(Judge, ScalesPicturesOfTheSameShapeOnly) {
    ForeignCamera camera;
    camera.lens = {.width = 1920, .height = 1080, .fx = 1500, .fy = 1500, .cx = 959.5, .cy = 539.5};
    ASSERT_TRUE(set_picture_size(camera, {960, 540}));
    EXPECT_DOUBLE_EQ(camera.lens.fx, 750.0);
    EXPECT_DOUBLE_EQ(camera.lens.cx, 479.5);
    const auto turned = set_picture_size(camera, {540, 960});
    ASSERT_FALSE(turned);
    EXPECT_THAT(turned.error().message, testing::HasSubstr("turned"));
    const auto cropped = set_picture_size(camera, {900, 540});
    ASSERT_FALSE(cropped);
    EXPECT_THAT(cropped.error().message, testing::HasSubstr("cropped"));
}

TEST(Judge, TellsRoundedShapesFromOthers) {
    using Size = std::array<int, 2>;
    for (const auto& [a, b] : std::vector<std::pair<Size, Size>>{{{1920, 1080}, {1280, 720}},
                                                                 {{1920, 1088}, {1280, 726}},
                                                                 {{1920, 1088}, {640, 362}},
                                                                 {{2448, 2048}, {1224, 1024}},
                                                                 {{2704, 1520}, {1280, 720}},
                                                                 {{64, 48}, {64, 48}},
                                                                 {{0, 0}, {64, 48}}}) {
        EXPECT_EQ(shape_difference(a, b), 0.0) << a[0] << " " << b[0];
        EXPECT_EQ(shape_difference(b, a), 0.0) << a[0] << " " << b[0];
    }
    EXPECT_NEAR(shape_difference({1920, 1088}, {1280, 720}), 0.0074, 1e-4);
    EXPECT_NEAR(shape_difference({1280, 720}, {1920, 1088}), 0.0074, 1e-4);
    EXPECT_NEAR(shape_difference({1920, 1080}, {1920, 1088}), 0.0074, 1e-4);
    EXPECT_NEAR(shape_difference({1600, 1200}, {1920, 1080}), 1.0 / 3.0, 0.1);
}

}  // namespace
}  // namespace atrium::calibrate
