#include "site_node/rig_check/floor_check.hpp"

#include "tests/support/shapes/closed_meshes.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/scene_maker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

namespace atrium::rig_check {
namespace {

using testing::HasSubstr;

// Feet at these heights, of somebody of 1.7 m, below whom the floor is seen.
std::optional<double> judge(const std::vector<double>& feet_m,
                            double height_m = 1.7,
                            bool is_floor_seen = true) {
    FloorCheck check;
    for (const double z : feet_m) check.add({{0.4, -0.2, z}, height_m}, is_floor_seen);
    return check.feet_off_floor_m();
}

std::vector<double> constant(double z, std::size_t count = 10) {
    return std::vector<double>(count, z);
}

TEST(FloorCheck, IsSilentAboutPeopleOnTheFloor) {
    for (const double z : {-0.2, -0.1, 0.0, 0.1, 0.15}) EXPECT_FALSE(judge(constant(z))) << z;
    EXPECT_FALSE(judge({}));
}

TEST(FloorCheck, FindsPeopleInTheFloorAndAboveIt) {
    EXPECT_DOUBLE_EQ(judge(constant(-0.74)).value_or(0.0), -0.74);
    EXPECT_DOUBLE_EQ(judge(constant(0.3)).value_or(0.0), 0.3);
    EXPECT_NEAR(judge({-0.8, -0.7, -0.7, -0.75, -0.72, -0.1, -0.74, -0.9, -0.74, -0.76, -0.74})
                    .value_or(0.0),
                -0.74,
                0.005);
}

TEST(FloorCheck, NeedsTenInstantsOfAWholePerson) {
    EXPECT_FALSE(judge(constant(-0.74, 9)));
    EXPECT_FALSE(judge(constant(-0.74, 30), 0.95));  // lies, or half of a person behind a table
    EXPECT_FALSE(judge(constant(-0.74, 30), 2.6));
    EXPECT_TRUE(judge(constant(-0.74), 1.3));  // on a chair
}

TEST(FloorCheck, IsSilentAboutFeetThatNoPictureMayShow) {
    EXPECT_FALSE(judge(constant(0.5, 30), 1.2, false));
    EXPECT_TRUE(judge(constant(-0.5), 1.7, false));
}

TEST(FloorCheck, IsSilentAboutPeopleWhoJumpOrClimb) {
    std::vector<double> feet_m = constant(0.0, 6);
    for (int i = 0; i < 20; ++i) feet_m.push_back(i % 2 == 0 ? 0.4 : 0.02);
    EXPECT_FALSE(judge(feet_m));
    std::vector<double> stage = constant(0.0, 100);
    stage.resize(400, 0.6);
    EXPECT_FALSE(judge(stage));
    // on both sides in turn: no height of the floor is right
    std::vector<double> tilted = constant(-0.3, 10);
    tilted.resize(20, 0.3);
    EXPECT_FALSE(judge(tilted));
}

// Cameras that look up a little, so that they do not see the floor below somebody who hangs high.
class LowerEnds : public testing::Test {
protected:
    // The hull's footing of somebody with feet at `feet_m`; below `hidden_px`, the picture of the
    // first camera is hidden.
    std::optional<Footing> look(double feet_m, double hidden_px = 1e9) {
        std::mt19937_64 random(7);
        test::Bodies bodies;
        bodies.parts = test::make_person(random, Eigen::Vector3d(0.0, 0.0, feet_m));
        const auto rig = test::make_ring_rig({.num_cameras = 6,
                                              .radius_m = 3.0,
                                              .heights_m = {1.3, 1.6},
                                              .target_site = {0.0, 0.0, 1.9},
                                              .size_px = 1000,
                                              .focal_px = 900.0});
        views_.clear();
        std::vector<hull::SilhouetteView> silhouettes = test::views_of(bodies, rig, {}, random);
        for (auto& contour : silhouettes[0].contours)
            for (Eigen::Vector2d& p : contour) p.y() = std::min(p.y(), hidden_px);
        for (std::size_t i = 0; i < silhouettes.size(); ++i)
            views_.push_back({rig[i].name, silhouettes[i]});
        hull::HullScratch scratch;
        return find_footing(hull::compute_visual_hull(silhouettes, {}, scratch).mesh);
    }

    std::vector<views::NamedView> views_;
};

TEST_F(LowerEnds, AreSeenOfPeopleWhoHangHigh) {
    for (const double feet_m : {0.6, 0.9, 1.2}) {
        const auto footing = look(feet_m);
        ASSERT_TRUE(footing) << feet_m;
        EXPECT_NEAR(footing->feet_site.z(), feet_m, 0.15);
        EXPECT_FALSE(sees_floor(views_, footing->feet_site, true)) << "the test cannot fail";
        EXPECT_TRUE(shows_lower_end(views_, *footing)) << feet_m;
    }
}

TEST_F(LowerEnds, AreNotSeenNearTheFloorNorBelowIt) {
    for (const double feet_m : {-1.2, -0.7, -0.3, 0.0, 0.3}) {
        const auto footing = look(feet_m);
        ASSERT_TRUE(footing) << feet_m;
        EXPECT_FALSE(shows_lower_end(views_, *footing)) << feet_m;
    }
}

TEST_F(LowerEnds, AreNotThoseThatADeskHidesFromOneCamera) {
    const auto footing = look(0.1, 620.0);
    ASSERT_TRUE(footing);
    ASSERT_GT(footing->feet_site.z(), 0.5) << "the test cannot fail";
    EXPECT_FALSE(shows_lower_end(views_, *footing));
}

TEST_F(LowerEnds, AreNotThoseThatBordersCut) {
    const auto footing = look(0.6);
    ASSERT_TRUE(footing);
    ASSERT_TRUE(shows_lower_end(views_, *footing));
    // pictures that end at the feet
    for (auto& view : views_) {
        double lowest_px = 0.0;
        for (const auto& contour : view.view.contours)
            for (const Eigen::Vector2d& p : contour) lowest_px = std::max(lowest_px, p.y());
        view.view.intrinsics.height = static_cast<int>(lowest_px) + 1;
    }
    EXPECT_FALSE(shows_lower_end(views_, *footing));
}

TEST(FloorCheck, SaysWhatWasMeasured) {
    const std::string unknown = explain_floor(-0.74, "door", 1.4);
    EXPECT_THAT(unknown, HasSubstr("a measured height or distance that was given to the import"));
    const std::string nothing = explain_floor(-0.74, "door", 1.4, Measured{});
    EXPECT_THAT(nothing, testing::Not(HasSubstr("measured height")));
    EXPECT_THAT(nothing, HasSubstr("as that of a board on a table does"));
}

TEST(FloorCheck, SaysCauseAndCure) {
    const std::string table = explain_floor(-0.74, "door", 1.4);
    EXPECT_THAT(table, HasSubstr("people stand 0.74 m below the floor"));
    EXPECT_THAT(table, HasSubstr("about 2.14 m"));
    EXPECT_THAT(table, HasSubstr("--camera-height door METRES"));
    const std::string above = explain_floor(0.3, "door", 1.4);
    EXPECT_THAT(above, HasSubstr("stay 0.30 m above the floor"));
    EXPECT_THAT(above, HasSubstr("nothing hides their feet"));
    EXPECT_THAT(above, HasSubstr("about 1.10 m"));
}

TEST(FindFooting, FindsTheLowestSectionOfHalfASole) {
    geometry::TriangleMesh mesh = test::make_octahedron({0.5, -1.0, 0.8}, 0.8);
    const auto footing = find_footing(mesh);
    ASSERT_TRUE(footing);
    // the section at height z is a square with a diagonal of 2 z: 2 z^2 = 0.01 m2 at 0.071 m
    EXPECT_NEAR(footing->feet_site.z(), 0.08, 1e-9);
    EXPECT_NEAR(footing->feet_site.x(), 0.5, 1e-9);
    EXPECT_NEAR(footing->feet_site.y(), -1.0, 1e-9);
    EXPECT_NEAR(footing->height_m, 1.52, 1e-9);
    // a thin spike below it does not count
    geometry::TriangleMesh spike = test::make_octahedron(Eigen::Vector3d::Zero(), 1.0);
    for (Eigen::Vector3d& p : spike.vertices)
        p = Eigen::Vector3d(0.5 + 0.03 * p.x(), -1.0 + 0.03 * p.y(), 0.5 * p.z() - 0.2);
    geometry::append(mesh, spike);
    const auto same = find_footing(mesh);
    ASSERT_TRUE(same);
    EXPECT_NEAR(same->feet_site.z(), 0.075, 0.01);
}

// The same person in a rig whose lengths are too short has soles that are smaller by the square.
TEST(FindFooting, FindsTheFeetAtAnyScale) {
    for (const double scale : {1.0, 0.75, 0.5, 0.25}) {
        // a body on legs of 60 cm2 and soles of 390 cm2
        geometry::TriangleMesh mesh =
            test::make_octahedron(scale * Eigen::Vector3d(0.0, 0.0, 1.15), scale * 0.6);
        const auto add = [&](double middle_m, double radius_m, double half_height_m) {
            geometry::TriangleMesh part = test::make_octahedron(Eigen::Vector3d::Zero(), 1.0);
            for (Eigen::Vector3d& p : part.vertices)
                p = scale * Eigen::Vector3d(radius_m * p.x(),
                                            radius_m * p.y(),
                                            middle_m + half_height_m * p.z());
            geometry::append(mesh, part);
        };
        add(0.05, 0.14, 0.05);
        add(0.5, 0.055, 0.5);
        const auto footing = find_footing(mesh);
        ASSERT_TRUE(footing);
        EXPECT_NEAR(footing->height_m, scale * 1.72, 0.02) << scale;
    }
}

TEST(FindFooting, FindsNoneInTinyEmptyAndTallMeshes) {
    EXPECT_FALSE(find_footing({}));
    EXPECT_FALSE(find_footing(test::make_octahedron(Eigen::Vector3d::Zero(), 0.04)));
    EXPECT_FALSE(find_footing(test::make_octahedron(Eigen::Vector3d::Zero(), 100.0)));
}

// The hull of cameras that look down ends below the feet.
TEST(FindFooting, IsNearTheFloorUnderSteepCameras) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        std::mt19937_64 random(seed);
        test::Bodies bodies;
        bodies.parts = test::make_person(random, Eigen::Vector3d::Zero());
        const auto rig = test::make_ring_rig(
            {.num_cameras = 4, .radius_m = 2.5, .heights_m = {2.6}, .focal_px = 700.0});
        const auto views = test::views_of(bodies, rig, {}, random);
        hull::HullScratch scratch;
        const hull::VisualHull hull = hull::compute_visual_hull(views, {}, scratch);
        ASSERT_EQ(hull.status, hull::HullStatus::kOk);
        const auto footing = find_footing(hull.mesh);
        ASSERT_TRUE(footing);
        EXPECT_FALSE(judge(constant(footing->feet_site.z()), footing->height_m))
            << footing->feet_site.z();
    }
}

}  // namespace
}  // namespace atrium::rig_check
