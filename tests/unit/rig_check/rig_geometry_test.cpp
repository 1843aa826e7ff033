#include "site_node/rig_check/rig_geometry.hpp"

#include "site_node/rig_check/bounds_check.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/scene_maker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::rig_check {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::uint64_t kNumRigs = test::kSanitized ? 10 : 60;

std::vector<geometry::CalibratedCamera> scaled(std::vector<geometry::CalibratedCamera> cameras,
                                               double factor) {
    for (auto& camera : cameras) camera.camera_from_site.translation *= factor;
    return cameras;
}

std::string text_of(const std::vector<Finding>& findings) {
    std::string text;
    for (const Finding& finding : findings)
        text += (finding.is_error ? "error " : "") + finding.text;
    return text;
}

TEST(RigGeometry, DoubtsBoundsInAnotherUnit) {
    const auto rig = test::make_ring_rig({.radius_m = 3.0});
    const geometry::Aabb room{{-1.5, -1.5, 0.0}, {1.5, 1.5, 2.4}};
    const auto text = [&](double factor, double unit_m) {
        const auto doubt = check_bounds({factor * room.min, factor * room.max}, rig, unit_m);
        return doubt ? doubt->text : std::string("none");
    };
    EXPECT_EQ(text(1.0, 1.0), "none");
    EXPECT_EQ(text(10.0, 1.0), "none") << "a hall around the rig";
    EXPECT_EQ(text(0.1, 1.0), "none") << "a table in the room";
    EXPECT_THAT(text(1000.0, 1.0),
                HasSubstr("[bounds] are 3000 m large, and the cameras at most 6 m apart: they look "
                          "like millimetres (3 m then); write them in metres"));
    EXPECT_THAT(text(100.0, 1.0), HasSubstr("look like centimetres (3 m then)"));
    EXPECT_THAT(text(0.01, 0.01),
                HasSubstr("look like metres (3 m then); write them in centimetres"));
}

TEST(RigGeometry, FindsNothingInGoodRigs) {
    for (std::uint64_t seed = 1; seed <= kNumRigs; ++seed) {
        test::Random random(seed);
        const test::Bodies bodies = test::make_bodies(test::BodyKind::kPeople, random);
        const auto kind = seed % 2 == 0 ? test::RigKind::kRing : test::RigKind::kAnywhere;
        const auto cameras =
            test::make_scene_rig(kind, 2 + static_cast<int>(seed % 10), bodies, random);
        EXPECT_EQ(text_of(check_rig(cameras)), "") << seed;
    }
    EXPECT_EQ(text_of(check_rig(test::make_ring_rig({.radius_m = 12.0}))), "");
}

TEST(RigGeometry, FindsNothingInCamerasAtOneWall) {
    for (std::uint64_t seed = 1; seed <= kNumRigs; ++seed) {
        test::Random random(seed);
        auto cameras = test::make_ring_rig({.num_cameras = 2 + static_cast<int>(seed % 5)});
        for (auto& camera : cameras) {
            const Eigen::Vector3d centre(
                test::between(random, -2.0, 2.0), -4.0, test::between(random, 0.5, 2.5));
            camera.camera_from_site =
                test::look_at(centre, Eigen::Vector3d(0, 0, 1) + test::random_in_cube(random, 0.5));
        }
        if (seed % 2 == 0) {  // in the frame of the first camera
            const auto site_from_camera = cameras.front().camera_from_site.inverse();
            for (auto& camera : cameras)
                camera.camera_from_site = camera.camera_from_site * site_from_camera;
        }
        EXPECT_EQ(text_of(check_rig(cameras)), "") << seed;
    }
}

TEST(RigGeometry, NamesTheUnitOfTheTranslations) {
    const auto rig = test::make_ring_rig({});
    const auto error_of = [&](double factor, double unit_m = 1.0) {
        const auto findings = check_rig(scaled(rig, factor), unit_m);
        return findings.empty() || !findings.front().is_error ? "" : findings.front().text;
    };
    EXPECT_THAT(error_of(1000.0), HasSubstr("look like millimetres ("));
    EXPECT_THAT(error_of(1000.0), HasSubstr("write units = \"mm\""));
    EXPECT_THAT(error_of(100.0), HasSubstr("look like centimetres ("));
    EXPECT_THAT(error_of(1.0 / 0.0254), HasSubstr("inches"));
    // the other way round
    EXPECT_THAT(error_of(0.001, 0.001), HasSubstr("units = \"m\" if they are"));
    EXPECT_THAT(error_of(0.0), HasSubstr("all translations say the same place"));
    EXPECT_EQ(error_of(1.0), "");
    EXPECT_EQ(error_of(0.02), "");
    EXPECT_EQ(error_of(10.0), "");
}

TEST(RigGeometry, DoubtsARigInWhichNobodyCanStand) {
    const auto rig = test::make_ring_rig({.radius_m = 3.0});
    EXPECT_THAT(text_of(check_rig(scaled(rig, 0.1))), HasSubstr("not for a person"));
    EXPECT_EQ(text_of(check_rig(scaled(rig, 0.3))), "");
}

TEST(RigGeometry, FindsInvertedExtrinsicsOfARing) {
    auto rig = test::make_ring_rig({});
    for (auto& camera : rig) camera.camera_from_site = camera.camera_from_site.inverse();
    EXPECT_THAT(text_of(check_rig(rig)), HasSubstr("site_from_camera (inverted)"));
}

TEST(RigGeometry, RefusesCamerasThatLookAway) {
    auto rig = test::make_ring_rig({});
    for (auto& camera : rig)
        camera.camera_from_site = corrected(camera.camera_from_site, Misreading::kOpenGl);
    EXPECT_THAT(text_of(check_rig(rig)), HasSubstr("error no point is seen by two cameras"));
    EXPECT_THAT(text_of(check_rig(rig)), HasSubstr("OpenGL"));
}

TEST(RigGeometry, NamesTheUpDirection) {
    auto rig = test::make_ring_rig({});
    const geometry::RigidTransform ours_from_y_up{
        Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * 3.141592653589793, Eigen::Vector3d::UnitX())),
        Eigen::Vector3d::Zero()};
    for (auto& camera : rig) camera.camera_from_site = camera.camera_from_site * ours_from_y_up;
    EXPECT_THAT(text_of(check_rig(rig)), HasSubstr("upright along +Y"));
}

TEST(RigGeometry, NamesIntrinsicsOfAnotherUnitOrPictureSize) {
    auto rig = test::make_ring_rig({});
    rig[1].intrinsics.fx = rig[1].intrinsics.fy = 8.0;
    EXPECT_THAT(text_of(check_rig(rig)), HasSubstr("look like millimetres"));
    rig = test::make_ring_rig({});
    rig[3].intrinsics.cx = rig[3].intrinsics.cy = 959.5;
    EXPECT_THAT(text_of(check_rig(rig)), HasSubstr("another picture size"));
    rig = test::make_ring_rig({});
    rig[3].intrinsics.fy *= 1.5;
    EXPECT_THAT(text_of(check_rig(rig)), HasSubstr("differ by more than 30 %"));
}

TEST(RigGeometry, CorrectionsUndoTheMistake) {
    test::Random random(7);
    for (const Misreading misreading : kMisreadings) {
        const geometry::RigidTransform truth{
            Eigen::Quaterniond(Eigen::AngleAxisd(1.1, test::random_direction(random))),
            test::random_in_cube(random, 3.0)};
        // a file with site_from_camera of a camera that looks along -Z: inverse, then flip
        const geometry::RigidTransform flip{Eigen::Quaterniond(0, 1, 0, 0), {0, 0, 0}};
        const geometry::RigidTransform written =
            misreading == Misreading::kInverted ? truth.inverse()
            : misreading == Misreading::kOpenGl ? flip * truth
                                                : (flip * truth).inverse();
        EXPECT_TRUE(corrected(written, misreading).matrix().isApprox(truth.matrix(), 1e-9));
    }
}

TEST(RigGeometry, NamesARigFarFromItsOrigin) {
    auto rig = test::make_ring_rig({.radius_m = 3.0});
    EXPECT_EQ(text_of(check_rig(rig)), "");
    for (auto& camera : rig)
        camera.camera_from_site.translation -=
            camera.camera_from_site.rotation * Eigen::Vector3d(40.0, -3.0, 0.0);
    EXPECT_THAT(text_of(check_rig(rig)),
                AllOf(HasSubstr("the cameras stand around a place at (40, -3, "),
                      HasSubstr("refuse people more than 15 m from the origin"),
                      HasSubstr("calibrate floor")));
}

TEST(RigGeometry, NamesDistortionInAnotherOrder) {
    auto rig = test::make_ring_rig({.radius_m = 3.0});
    for (auto& camera : rig) camera.intrinsics.distortion = {0.4, -2.6, 1.51, 0.28, -2.4};
    EXPECT_THAT(text_of(check_rig(rig)),
                AllOf(HasSubstr("its distortion has p1 = 1.51 and p2 = 0.28, which no lens has"),
                      HasSubstr("k1, k2, p1, p2, k3, k4, k5, k6")));
    for (auto& camera : rig) camera.intrinsics.distortion = {-0.4, 0.2, 0.01, -0.02, 0.0};
    EXPECT_EQ(text_of(check_rig(rig)), "");
}

TEST(CheckRegion, DoubtsOneThatTheCamerasDoNotReach) {
    const auto rig = test::make_ring_rig({.radius_m = 3.0});
    EXPECT_FALSE(check_region({{-0.5, -0.5, 0.0}, {0.5, 0.5, 2.0}}, rig));
    EXPECT_FALSE(check_region({{-8.0, -8.0, 0.0}, {8.0, 8.0, 2.0}}, rig)) << "larger than the room";
    const geometry::Aabb room{{-1.5, -1.5, 0.0}, {1.5, 1.5, 2.4}};
    const geometry::Aabb beside{{1.6, -1.0, 0.0}, {2.6, 1.0, 2.0}};
    EXPECT_FALSE(check_region(beside, rig));
    const auto outside = check_region(beside, rig, room);
    ASSERT_TRUE(outside);
    EXPECT_THAT(outside->text, HasSubstr("outside of [bounds] of the rig"));
    EXPECT_FALSE(check_region({{0.0, -1.0, 0.0}, {2.6, 1.0, 2.0}}, rig, room));
    const auto far = check_region({{40.0, -2.0, 0.0}, {44.0, 2.0, 3.0}}, rig);
    ASSERT_TRUE(far);
    EXPECT_THAT(far->text, HasSubstr("outside the room"));
    EXPECT_TRUE(check_region({{-0.5, -0.5, 6.0}, {0.5, 0.5, 8.0}}, rig)) << "above all pictures";
}

}  // namespace
}  // namespace atrium::rig_check
