// The frame of a room from a board or lights on its floor.
#include "filmed_room.hpp"
#include "lost_rig.hpp"
#include "tools/calibrate/floor/find_marks.hpp"
#include "tools/calibrate/floor/floor_frame.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace atrium::calibrate {
namespace {

using calibrate_test::large_board;
using calibrate_test::lost_rig;
using calibrate_test::LostRig;
using calibrate_test::lying;
using calibrate_test::seen_px;
using testing::HasSubstr;

void expect_frame(const FloorFrame& frame,
                  const geometry::RigidTransform& rig_from_floor,
                  double most_m) {
    EXPECT_LT((frame.rig_from_floor.translation - rig_from_floor.translation).norm(), most_m);
    EXPECT_LT(frame.rig_from_floor.rotation.angularDistance(rig_from_floor.rotation), most_m);
}

class Floors : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Floors, AreThoseOfABoardThatLiesThere) {
    const LostRig lost = lost_rig(GetParam());
    const Board board = large_board();
    constexpr double kYaw = 0.4, kThickness_m = 0.012;
    geometry::RigidTransform site_from_board;  // its pattern is higher than the floor
    site_from_board.rotation = Eigen::AngleAxisd(kYaw, Eigen::Vector3d::UnitZ());
    site_from_board.translation = {0.1, -0.2, kThickness_m};
    const auto found =
        marks_of_board(lost.rig, {board}, lying(lost, board, site_from_board, GetParam()));
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_TRUE(found->problems.empty()) << found->problems.front();
    const auto frame = floor_frame(found->marks, lost.rig.cameras, {kYaw, kThickness_m});
    ASSERT_TRUE(frame) << frame.error().message;
    geometry::RigidTransform site_from_floor;
    site_from_floor.translation = {0.1, -0.2, 0.0};
    expect_frame(*frame, lost.rig_from_site * site_from_floor, 0.002);
    EXPECT_EQ(frame->num_below, 0U);
}

TEST_P(Floors, AreThoseOfLightsThatLieThere) {
    const LostRig lost = lost_rig(GetParam());
    const std::vector<Eigen::Vector3d> lights{
        {0, 0, 0}, {0.8, 0, 0}, {0.1, 0.6, 0}, {-0.5, -0.4, 0}, {0.6, -0.5, 0}};
    const auto points_of = [&](const std::vector<std::uint32_t>& numbers) {
        LightPoints points;
        for (const auto& camera : lost.rig.cameras) {
            points.push_back({camera.name, {}});
            for (std::uint32_t i = 0; i < lights.size(); ++i)
                points.back().points.push_back(
                    {0, numbers[i], seen_px(camera, lost.rig_from_site * lights[i])});
        }
        return points;
    };
    const auto found = marks_of_lights(lost.rig, points_of({0, 1, 2, 3, 4}), std::nullopt);
    ASSERT_TRUE(found) << found.error().message;
    const auto frame = floor_frame(found->marks, lost.rig.cameras, {});
    ASSERT_TRUE(frame) << frame.error().message;
    expect_frame(*frame, lost.rig_from_site, 1e-6);
    EXPECT_LT(frame->rms_m, 1e-6);
    // 1 and 2 swapped: the cameras would be below the floor
    const auto swapped = marks_of_lights(lost.rig, points_of({0, 2, 1, 3, 4}), std::nullopt);
    ASSERT_TRUE(swapped) << swapped.error().message;
    EXPECT_THAT(floor_frame(swapped->marks, lost.rig.cameras, {}).error().message,
                HasSubstr("4 of 4 cameras would be below the floor"));
}

// The known default wand, laid down twice, with lights that have no numbers.
TEST_P(Floors, AreThoseOfAWandThatLiesThere) {
    const LostRig lost = lost_rig(GetParam());
    const Wand wand = default_wand();
    LightPoints points;
    for (const auto& camera : lost.rig.cameras) {
        points.push_back({camera.name, {}});
        for (std::uint32_t instant = 0; instant < 2; ++instant)
            for (const Eigen::Vector3d& light : wand.lights_m) {
                const Eigen::Vector3d place =
                    instant == 0 ? light : Eigen::Vector3d(0.2, -0.3 + light.x(), 0.0);
                points.back().points.push_back(
                    {instant, std::nullopt, seen_px(camera, lost.rig_from_site * place)});
            }
    }
    const auto found = marks_of_lights(lost.rig, points, wand);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_TRUE(found->problems.empty());
    const auto frame = floor_frame(found->marks, lost.rig.cameras, {});
    ASSERT_TRUE(frame) << frame.error().message;
    expect_frame(*frame, lost.rig_from_site, 1e-5);
}
INSTANTIATE_TEST_SUITE_P(Rooms, Floors, testing::Range(1U, 5U));

TEST(FloorFaults, AreNamed) {
    const LostRig lost = lost_rig(1);
    const Board board = large_board();
    BoardPoints points = lying(lost, board, {}, 1);
    // a camera that moved since the calibration
    BoardPoints moved = points;
    for (BoardCorner& corner : moved[2].corners) corner.px += Eigen::Vector2d(30.0, -14.0);
    EXPECT_THAT(marks_of_board(lost.rig, {board}, moved).error().message,
                HasSubstr("the rig does not fit these pictures"));
    moved = points;
    for (BoardCorner& corner : moved[0].corners)
        corner.px.x() += 9.0 * static_cast<double>(corner.instant);
    EXPECT_THAT(marks_of_board(lost.rig, {board}, moved).error().message,
                HasSubstr("the board moves in the pictures of camera 'cam0'"));
    moved = points;
    moved[0].name = "other";
    EXPECT_THAT(marks_of_board(lost.rig, {board}, moved).error().message,
                HasSubstr("the rig has no camera 'other'"));
    for (BoardCamera& camera : moved = points) camera.corners.clear();
    EXPECT_THAT(marks_of_board(lost.rig, {board}, moved).error().message,
                HasSubstr("no camera of the rig shows the board"));
    Board wrong = board;  // all squares are larger than they say
    wrong.square_m = 0.97 * board.square_m;
    const auto scaled = marks_of_board(lost.rig, {wrong}, points);
    EXPECT_TRUE(!scaled || !scaled->checks.empty() || !scaled->problems.empty());

    const LightPoints unnumbered{{"cam0", {{0, std::nullopt, {5, 5}}}}};
    EXPECT_THAT(marks_of_lights(lost.rig, unnumbered, std::nullopt).error().message,
                HasSubstr("number the lights"));
    FloorMarks line;
    line.on_x = {1, 0, 0};
    line.on_y_side = {2, 0, 0};
    line.on_floor = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    EXPECT_THAT(floor_frame(line, lost.rig.cameras, {}).error().message,
                HasSubstr("lie on a line"));
}

}  // namespace
}  // namespace atrium::calibrate
