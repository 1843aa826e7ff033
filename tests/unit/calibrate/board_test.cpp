// Calibration with boards, in simulated rooms with known cameras.
#include "filmed_room.hpp"
#include "tests/support/sanitized.hpp"
#include "tools/calibrate/board/judge_board.hpp"
#include "tools/calibrate/board/solve_board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace atrium::calibrate {
namespace {

using calibrate_test::centres_off_m;
using calibrate_test::FilmedRoom;
using calibrate_test::large_board;
using calibrate_test::show;
using calibrate_test::ShowOptions;
using testing::AnyOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

Expected<BoardSolution> solve_room(const FilmedRoom& room) {
    BoardOptions options;
    options.num_threads = 2;
    return solve_board(room.boards, room.points, options);
}

std::vector<std::string> problems_of_room(const FilmedRoom& room) {
    const auto solution = solve_room(room);
    if (!solution) return {solution.error().message};
    return judge_board(*solution, 30.0).problems;
}

double off_m(const FilmedRoom& room, const BoardSolution& solution) {
    std::vector<Eigen::Vector3d> centres;
    for (const BundleCamera& camera : solution.rig.bundle.cameras)
        centres.push_back(camera.centre_world());
    return centres_off_m(room.cameras, centres);
}

// Of 0.5 x 0.7 m: as wide as a fifth of the pictures.
Board wall_board() {
    Board board = large_board();
    board.square_m = 0.1;
    board.marker_m = 0.075;
    return board;
}

class ShownBoard : public testing::TestWithParam<std::uint32_t> {};

TEST_P(ShownBoard, GivesTheCamerasWithoutAGuess) {
    ShowOptions options;
    options.seed = GetParam();
    options.ring = 0.6;  // neighbours see the same side of the board
    const FilmedRoom room = show({wall_board()}, options);
    const auto solution = solve_room(room);
    ASSERT_TRUE(solution) << solution.error().message;
    double variance_m2 = 0.0;
    for (const CameraUncertainty& open : solution->uncertainties)
        variance_m2 += open.place_m * open.place_m / 4.0;
    EXPECT_LT(off_m(room, *solution), 3.0 * std::sqrt(variance_m2));
    EXPECT_LT(off_m(room, *solution), 0.006);
    EXPECT_LT(solution->rig.held_out_px, options.noise_px + 0.05);
    EXPECT_GT(solution->rig.rms_px, options.noise_px - 0.03)
        << "outliers must not be all that is left";
    EXPECT_NEAR(solution->sigma_px, options.noise_px, 0.02);
    for (std::size_t c = 0; c < room.cameras.size(); ++c) {
        const BundleCamera& camera = solution->rig.bundle.cameras[c];
        const double focal = room.cameras[c].intrinsics.fx;
        EXPECT_NEAR(camera.lens[0], focal, 0.005 * focal) << c;
        const CameraUncertainty& open = solution->uncertainties[c];
        EXPECT_LT(std::abs(camera.lens[0] / focal - 1.0), 5.0 * open.focal) << c;
        EXPECT_LT(open.focal, 0.003) << c;
        EXPECT_GT(open.focal, 1e-5) << c;
    }
    const Verdict verdict = judge_board(*solution, 30.0);
    EXPECT_THAT(verdict.problems, IsEmpty());
    EXPECT_THAT(verdict.told, Contains(HasSubstr("good: ")));
}
INSTANTIATE_TEST_SUITE_P(Rooms, ShownBoard, testing::Range(1U, test::kSanitized ? 2U : 6U));

TEST(ShownBoards, MayBeSeveral) {
    Board second = wall_board();
    second.first_id = 17;
    second.columns = 7;
    second.rows = 5;
    const FilmedRoom room = show({wall_board(), second}, {});
    const auto solution = solve_room(room);
    ASSERT_TRUE(solution) << solution.error().message;
    EXPECT_LT(off_m(room, *solution), 0.006);
    EXPECT_THAT(judge_board(*solution, 30.0).problems, IsEmpty());
}

TEST(ShownBoards, NameACameraThatSeesThemAlone) {
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
        ShowOptions options;
        options.seed = seed;
        FilmedRoom room = show({large_board()}, options);
        for (BoardCorner& corner : room.points[2].corners) corner.instant += 1000;
        EXPECT_THAT(problems_of_room(room),
                    ElementsAre(HasSubstr("camera 'cam2' never shows the board together with")));
    }
}

TEST(ShownBoards, NameTwoGroupsThatShareNone) {
    FilmedRoom room = show({large_board()}, {});
    for (const std::size_t c : {1U, 2U})
        for (BoardCorner& corner : room.points[c].corners) corner.instant += 1000;
    EXPECT_THAT(
        problems_of_room(room),
        ElementsAre(testing::ContainsRegex("shows the board together with 'cam.', but in")));
}

TEST(ShownBoards, NameACameraWithFewPictures) {
    FilmedRoom room = show({large_board()}, {});
    std::erase_if(room.points[1].corners,
                  [](const BoardCorner& corner) { return corner.instant > 3; });
    EXPECT_THAT(problems_of_room(room), ElementsAre(HasSubstr("camera 'cam1' shows the board")));
}

// Two cameras side by side see every board frontally: nothing tells how far away it is.
TEST(ShownBoards, LeaveTheFocalLengthOpenIfNeverTilted) {
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
        ShowOptions options;
        options.seed = seed;
        options.num_cameras = 2;
        options.ring = 0.03;
        options.is_frontal = true;
        options.noise_px = 0.4;
        EXPECT_THAT(problems_of_room(show({large_board()}, options)),
                    Contains(HasSubstr("Tilt the board by 30 to 60 degrees")))
            << seed;
    }
}

TEST(ShownBoards, NameACameraThatIsLate) {
    for (const double late : {1.0, -1.0, 3.0}) {
        ShowOptions options;
        options.num_instants = 120;
        options.late_instants = late;
        const std::string word =
            late > 0.0 ? "camera 'cam3' is late by" : "camera 'cam3' is early by";
        EXPECT_THAT(problems_of_room(show({large_board()}, options)), ElementsAre(HasSubstr(word)))
            << late;
    }
}

// Without a common trigger, or on a computer that is too slow for its cameras, some pictures show
// the board elsewhere. Most of their corners are outliers, and the errors of the rest are small.
TEST(ShownBoards, AreNotGoodWherePicturesAreOfOtherTimes) {
    for (const std::uint32_t seed : {1U, 2U, 3U, 4U}) {
        ShowOptions options;
        options.seed = seed;
        options.num_cameras = 5;
        options.num_instants = 80;
        options.jitter_instants = 1.0;
        options.jitter_share = 0.1 * seed;
        const auto told = problems_of_room(show({wall_board()}, options));
        ASSERT_THAT(told, Not(IsEmpty())) << seed;
        EXPECT_THAT(told.front(),
                    AnyOf(HasSubstr("of all corners contradict the others, so the cameras may be"),
                          HasSubstr("contradicts the others in")))
            << seed;
        options.jitter_share = 0.06;
        const auto some = solve_room(show({wall_board()}, options));
        ASSERT_TRUE(some) << some.error().message;
        EXPECT_THAT(judge_board(*some, 30.0).told.front(), Not(HasSubstr("good: "))) << seed;
        options.jitter_instants = 0.0;
        const auto still = solve_room(show({wall_board()}, options));
        ASSERT_TRUE(still) << still.error().message;
        EXPECT_THAT(judge_board(*still, 30.0).problems, IsEmpty()) << seed;
        EXPECT_THAT(judge_board(*still, 30.0).told.front(), HasSubstr("good: ")) << seed;
    }
}

TEST(ShownBoards, NameACameraOfAnotherRoom) {
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
        ShowOptions options;
        options.seed = seed;
        FilmedRoom room = show({large_board()}, options);
        options.seed = seed + 10;
        room.points[1].corners = show({large_board()}, options).points[1].corners;
        EXPECT_THAT(problems_of_room(room), ElementsAre(HasSubstr("camera 'cam1' contradicts")));
    }
}

TEST(ShownBoards, NameTwoCamerasWithTheSamePictures) {
    FilmedRoom room = show({large_board()}, {});
    EXPECT_EQ(same_board_pictures(room.points), "");
    room.points[3].corners = room.points[0].corners;
    EXPECT_THAT(same_board_pictures(room.points),
                HasSubstr("cameras 'cam0' and 'cam3' have the same pictures"));
}

// A chessboard is found in mirrored pictures, too, with its columns the other way round.
TEST(ShownBoards, NameMirroredPicturesOfAChessboard) {
    for (const int columns : {6, 7}) {
        Board board = large_board();
        board.kind = BoardKind::kChessboard;
        board.columns = columns;
        board.rows = 13 - columns;
        ShowOptions options;
        options.is_last_mirrored = true;
        FilmedRoom room = show({board}, options);
        for (BoardCorner& corner : room.points[3].corners) {
            const auto per_row = static_cast<std::uint32_t>(board.columns - 1);
            const std::uint32_t column = corner.corner % per_row, row = corner.corner / per_row;
            const auto last_row = static_cast<std::uint32_t>(board.rows - 2);
            // as the detector takes it, whose top left square is black
            corner.corner = columns % 2 == 1 ? row * per_row + per_row - 1 - column
                                             : (last_row - row) * per_row + column;
        }
        EXPECT_THAT(problems_of_room(room),
                    ElementsAre(HasSubstr("the pictures of camera 'cam3' are mirrored")));
    }
}

// Small boards that always lean about alike: turned cameras explain them as well.
TEST(ShownBoards, RefuseARoomThatMayBeAnother) {
    int num_found = 0;
    for (const std::uint32_t seed : {1U, 2U, 3U, 4U}) {
        ShowOptions options;
        options.seed = seed;
        options.num_cameras = 2;
        options.ring = 0.2;
        options.num_instants = 5;
        options.noise_px = 0.6;
        options.distance_m = 6.0;
        Board small = large_board();
        small.square_m = 0.03;
        small.marker_m = 0.0225;
        const FilmedRoom room = show({small}, options);
        const auto solution = solve_room(room);
        // the truth, or refused
        if (solution && judge_board(*solution, 30.0).problems.empty())
            EXPECT_LT(off_m(room, *solution), 0.2) << seed;
        else
            ++num_found;
    }
    EXPECT_GT(num_found, 0);
}

}  // namespace
}  // namespace atrium::calibrate
