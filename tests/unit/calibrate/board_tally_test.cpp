// What `calibrate board` and `calibrate floor` still need of live cameras.
#include "tools/calibrate/sweep/board_tally.hpp"

#include "core/geometry/rigid_transform.hpp"
#include "tools/calibrate/board/leaning.hpp"
#include "tools/calibrate/sweep/resting_board.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace atrium::calibrate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kFocal_px = 600.0;
constexpr int kWidth = 640, kHeight = 480;

Detection nothing() { return {}; }

// All corners of a board whose middle is at (x, y) [px] and `away_m` away, turned about its
// vertical.
Detection shown(double x, double y, double away_m, double turn_deg, const Board& board = {}) {
    const Eigen::Vector3d middle(
        (x - kWidth / 2.0) * away_m / kFocal_px, (y - kHeight / 2.0) * away_m / kFocal_px, away_m);
    const Eigen::AngleAxisd turn(turn_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY());
    const Eigen::Vector3d half(
        0.5 * board.columns * board.square_m, 0.5 * board.rows * board.square_m, 0.0);
    Detection found;
    for (std::size_t i = 0; i < board.num_corners(); ++i) {
        const Eigen::Vector3d p = middle + turn * Eigen::Vector3d(board.corner_m(i) - half);
        found.corners.push_back({static_cast<std::uint32_t>(i),
                                 {kFocal_px * p.x() / p.z() + kWidth / 2.0,
                                  kFocal_px * p.y() / p.z() + kHeight / 2.0}});
    }
    return found;
}

std::vector<NominalCamera> cameras(std::size_t num) {
    std::vector<NominalCamera> all;
    for (std::size_t c = 0; c < num; ++c)
        all.push_back({"cam" + std::to_string(c), kWidth, kHeight, 0.0});
    return all;
}

TEST(Leaning, IsTheRatioOfTheDepths) {
    const Board board;
    EXPECT_NEAR(leaning_of({board}, shown(320, 240, 1.0, 0.0).corners), 1.0, 1e-9);
    for (const double turn_deg : {20.0, 45.0, -60.0}) {
        // between the outer columns of corners
        const double reach = 0.5 * (board.columns - 2) * board.square_m *
                             std::abs(std::sin(turn_deg * std::numbers::pi / 180.0));
        EXPECT_NEAR(leaning_of({board}, shown(200, 300, 0.8, turn_deg).corners),
                    (0.8 + reach) / (0.8 - reach),
                    1e-6)
            << turn_deg;
    }
}

TEST(Leaning, IsThatOfTheBoardThatLeansMost) {
    const Board board;
    Detection both = shown(100, 100, 1.0, 0.0);
    for (SeenCorner corner : shown(400, 300, 1.0, 50.0).corners) {
        corner.corner += static_cast<std::uint32_t>(board.num_corners());
        both.corners.push_back(corner);
    }
    EXPECT_NEAR(leaning_of({board, board}, both.corners),
                leaning_of({board}, shown(400, 300, 1.0, 50.0).corners),
                1e-6);
    EXPECT_EQ(leaning_of({board}, {}), 1.0);
}

class ShowingBoards : public testing::Test {
protected:
    void begin(std::size_t num_cameras, const BoardNeeds& needs = {}) {
        tally_.emplace(std::vector<Board>{Board{}}, cameras(num_cameras), needs);
        time_s_ = 0.0;
    }
    void show(const std::vector<std::optional<Detection>>& seen) {
        tally_->add(instant_++, time_s_ += 0.1, seen);
    }

    std::optional<BoardTally> tally_;
    std::uint32_t instant_ = 0;
    double time_s_ = 0.0;
};

TEST_F(ShowingBoards, CountsPlacesThatAreNew) {
    begin(2);
    for (int i = 0; i < 10; ++i) show({shown(100 + i, 100, 1.0, 0.0), nothing()});
    EXPECT_EQ(tally_->cameras()[0].num_places, 1u) << "it moved by 9 px of 640";
    for (int i = 0; i < 10; ++i) show({shown(120 + 20 * i, 100, 1.0, 0.0), nothing()});
    EXPECT_EQ(tally_->cameras()[0].num_places, 11u);
    EXPECT_EQ(tally_->cameras()[0].num_tilted, 0u);
    EXPECT_EQ(tally_->cameras()[0].num_shared, 0u);
    show({shown(120, 300, 0.5, 45.0), shown(300, 300, 1.0, 10.0)});
    EXPECT_EQ(tally_->cameras()[0].num_tilted, 1u);
    EXPECT_EQ(tally_->cameras()[0].num_shared, 1u);
    EXPECT_EQ(tally_->cameras()[1].num_shared, 1u);
    // the corners of the places, and all pictures are counted
    EXPECT_EQ(tally_->films()[0].camera.corners.size(), 12u * Board{}.num_corners());
    EXPECT_EQ(tally_->films()[0].camera.num_pictures, 21u);
    EXPECT_EQ(tally_->films()[1].num_views, 1u);
}

TEST_F(ShowingBoards, SaysWhatIsMissingUntilItIsEnough) {
    const BoardNeeds needs{6, 3, 4, 0.2};
    begin(2, needs);
    EXPECT_THAT(tally_->progress(), HasSubstr("boards: 0 of 2 cameras; cam0: 0 of 6 places"));
    for (int i = 0; i < 6; ++i) show({shown(100 + 20 * i, 100, 1.0, 0.0), nothing()});
    EXPECT_THAT(tally_->need_of(0), HasSubstr("of 20 % of its picture, show it lower left"));
    for (int i = 0; i < 6; ++i) show({shown(100 + 80 * i, 380, 1.0, 0.0), nothing()});
    EXPECT_EQ(tally_->need_of(0), "tilted 0 of 3 times, tilt it more or come nearer");
    for (int i = 0; i < 3; ++i) show({shown(100 + 80 * i, 200, 0.5, 45.0), nothing()});
    EXPECT_EQ(tally_->need_of(0), "with another camera 0 of 4 times");
    for (int i = 0; i < 8; ++i)
        show({shown(100 + 50 * i, 240, 0.6, 40.0), shown(500 - 50 * i, 100 + 40 * i, 0.6, -40.0)});
    EXPECT_EQ(tally_->need_of(0), "");
    EXPECT_EQ(tally_->need_of(1), "");
    EXPECT_TRUE(tally_->is_complete());
    EXPECT_EQ(tally_->progress(), "boards: 2 of 2 cameras; enough: cam0, cam1");
}

TEST_F(ShowingBoards, AsksForALinkBetweenPairsOfCameras) {
    begin(4, {4, 0, 4, 0.0});
    for (int i = 0; i < 6; ++i) {
        const Detection one = shown(100 + 60 * i, 200, 0.8, 30.0);
        show({one, one, nothing(), nothing()});
        show({nothing(), nothing(), one, one});
    }
    EXPECT_FALSE(tally_->is_complete());
    EXPECT_THAT(tally_->progress(),
                HasSubstr("hold it where cam0, cam1 and the others see it at once"));
    // cameras that have enough still count what links them
    for (int i = 0; i < 4; ++i) {
        const Detection one = shown(100 + 60 * i, 350, 0.8, 30.0);
        show({nothing(), one, one, nothing()});
    }
    EXPECT_TRUE(tally_->is_complete());
}

TEST_F(ShowingBoards, KeepsNoMoreOfTheSame) {
    begin(2, {4, 0, 4, 0.0});
    const auto carry = [&](int num) {
        for (int i = 0; i < num; ++i) {
            const Detection one = shown(100 + 60 * (i % 7), 100 + 30 * (i % 5), 0.8, 30.0);
            show({one, one});
        }
    };
    carry(10);
    ASSERT_TRUE(tally_->is_complete());
    const std::size_t num_corners = tally_->films()[0].camera.corners.size();
    carry(500);
    EXPECT_EQ(tally_->films()[0].camera.corners.size(), num_corners);
}

TEST_F(ShowingBoards, KeepsOnlyWhatIsMissingOfManyPlaces) {
    begin(1, {4, 0, 0, 0.5});
    for (int i = 0; i < 500; ++i) show({shown(100 + 60 * (i % 3), 100, 1.5, 0.0)});
    EXPECT_FALSE(tally_->is_complete());
    EXPECT_EQ(tally_->cameras()[0].num_places, 8u);
    show({shown(400, 300, 1.5, 0.0)});
    EXPECT_EQ(tally_->cameras()[0].num_places, 9u) << "new in its picture";
}

TEST_F(ShowingBoards, WarnsOfCamerasWithoutPictures) {
    begin(2);
    for (int i = 0; i < 100; ++i) show({nothing(), std::nullopt});
    EXPECT_THAT(tally_->take_warnings(), ElementsAre("camera 'cam1' sends no pictures"));
    EXPECT_THAT(tally_->take_warnings(), IsEmpty());
}

TEST_F(ShowingBoards, ShortensItsLineForATerminal) {
    begin(12);
    EXPECT_LE(tally_->progress(80).size(), 80u);
    EXPECT_THAT(tally_->progress(80), HasSubstr("; ..."));
}

TEST_F(ShowingBoards, KeepsTheNewestSamples) {
    begin(1);
    for (int i = 0; i < 5; ++i) tally_->sample(0, {1, 1, {static_cast<std::uint8_t>(i)}});
    ASSERT_EQ(tally_->films()[0].samples.size(), 3u);
    EXPECT_EQ(tally_->films()[0].samples.back().pixels[0], 4);
}

TEST(RestingBoard, WaitsUntilTheBoardLiesStill) {
    RestingBoard resting(cameras(2));
    EXPECT_EQ(resting.progress(), "floor: no camera sees the board");
    std::uint32_t instant = 0;
    for (int i = 0; i < 30; ++i) resting.add(instant++, {shown(100 + 9 * i, 100, 1, 0), nothing()});
    EXPECT_FALSE(resting.is_complete()) << "it is carried";
    for (int i = 0; i < 19; ++i) resting.add(instant++, {shown(400, 100, 1, 0), std::nullopt});
    EXPECT_THAT(resting.progress(), HasSubstr("floor: cam0 sees the board at rest: 19 of 20"));
    resting.add(instant++, {shown(405, 100, 1, 0), nothing()});
    EXPECT_FALSE(resting.is_complete()) << "somebody kicked it";
    // a camera that sees it now and then does not disturb, and noise neither
    for (int i = 0; i < 20; ++i)
        resting.add(instant++,
                    {shown(405.0 + 0.1 * (i % 3), 100, 1, 0),
                     i % 3 == 0 ? shown(200, 200, 2, 20) : nothing()});
    EXPECT_TRUE(resting.is_complete());
    const auto films = resting.films();
    EXPECT_EQ(films[0].num_views, 20u);
    EXPECT_GE(films[1].num_views, 6u);
    EXPECT_EQ(films[0].camera.corners.front().instant, instant - 20);
}

TEST(RestingBoard, BeginsAnewWhenNobodySeesIt) {
    RestingBoard resting(cameras(1));
    for (std::uint32_t i = 0; i < 15; ++i) resting.add(i, {shown(100, 100, 1, 0)});
    resting.add(15, {nothing()});
    for (std::uint32_t i = 16; i < 35; ++i) resting.add(i, {shown(100, 100, 1, 0)});
    EXPECT_FALSE(resting.is_complete());
}

}  // namespace
}  // namespace atrium::calibrate
