// The board of simulated rooms, which knows nothing of `calibrate print-board`.
#include "simulation/board_room.hpp"
#include "tests/unit/simulation/rig_fixture.hpp"
#include "tools/calibrate/board/detect.hpp"
#include "tools/calibrate/board/print_board.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace atrium::calibrate {
namespace {

TEST(SimulatedBoard, IsTheOneThatIsPrinted) {
    const Board board;
    ASSERT_EQ(board.columns, simulation::kBoardColumns);
    ASSERT_EQ(board.rows, simulation::kBoardRows);
    const std::vector<PrintedRect> rects = printed_rects(board);
    constexpr int kSteps = 24;  // per square; three in a cell of a marker, none on an edge
    int num_black = 0;
    for (int row = 0; row < kSteps * board.rows; ++row) {
        for (int column = 0; column < kSteps * board.columns; ++column) {
            const Eigen::Vector2d p =
                board.square_m / kSteps * Eigen::Vector2d(column + 0.5, row + 0.5);
            const bool is_printed = std::ranges::any_of(rects, [&](const PrintedRect& r) {
                return p.x() > r.left && p.x() < r.left + r.width && p.y() > r.bottom &&
                       p.y() < r.bottom + r.height;
            });
            ASSERT_EQ(simulation::is_black(p, board.square_m), is_printed) << p.transpose();
            num_black += is_printed ? 1 : 0;
        }
    }
    EXPECT_GT(num_black, kSteps * kSteps * 18);
    EXPECT_EQ(simulation::is_black({-0.017, 0.1}, board.square_m), false);
    EXPECT_EQ(simulation::is_black({-0.019, 0.1}, board.square_m), std::nullopt);
    EXPECT_EQ(simulation::is_black({0.1, 0.269}, board.square_m), false);
    EXPECT_EQ(simulation::is_black({0.1, 0.271}, board.square_m), std::nullopt);
}

TEST(SimulatedBoard, IsFoundWhereItIsThroughADistortedLens) {
    config::Rig rig;
    rig.cameras = simulation::ring(4, 640, 512);
    for (geometry::CalibratedCamera& camera : rig.cameras)
        camera.intrinsics.distortion = {-0.12, 0.03, 0.0, 0.0, 0.0};
    rig.bounds_site = {{-1.0, -1.0, 0.1}, {1.0, 1.0, 2.1}};
    simulation::BoardRoomOptions options;
    const simulation::BoardRoom room(rig, options);
    Board board;
    board.square_m = options.square_m;
    board.marker_m = 0.75 * options.square_m;
    const BoardDetector detector({board});
    std::vector<std::size_t> num_views(rig.cameras.size());
    std::vector<double> errors_px;
    std::size_t num_pairs = 0;
    image::Plane picture;
    for (int instant = 0; instant < 30; instant += 2) {  // once around
        std::size_t num_seeing = 0;
        for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
            room.render(instant, camera, picture);
            const Detection found = detector.detect({picture.width, picture.height, picture.data});
            const geometry::RigidTransform camera_from_board =
                rig.cameras[camera].camera_from_site * room.site_from_board(instant);
            const geometry::PinholeCamera& lens = rig.cameras[camera].intrinsics;
            for (const SeenCorner& corner : found.corners) {
                const Eigen::Vector2d px =
                    lens.distort(lens.project(camera_from_board * board.corner_m(corner.corner)));
                errors_px.push_back((corner.px - px).norm());
            }
            num_views[camera] += found.corners.empty() ? 0 : 1;
            num_seeing += found.corners.empty() ? 0 : 1;
        }
        num_pairs += num_seeing >= 2 ? 1 : 0;
    }
    for (const std::size_t num : num_views) EXPECT_GE(num, 3u);
    EXPECT_GE(num_pairs, 3u);
    ASSERT_GT(errors_px.size(), 300u);
    std::ranges::sort(errors_px);
    EXPECT_LT(errors_px[errors_px.size() / 2], 0.15);
    // the detector misses a corner now and then, where a cell of a marker has three pixels
    EXPECT_LT(errors_px[errors_px.size() * 98 / 100], 1.0);
}

TEST(SimulatedBoard, IsNotInTheEmptyRoom) {
    config::Rig rig;
    rig.cameras = simulation::ring(2, 160, 120);
    rig.bounds_site = {{-1.0, -1.0, 0.1}, {1.0, 1.0, 2.1}};
    const simulation::BoardRoom room(rig, {});
    image::Plane first, second;
    room.render_empty(0, 1, first);
    room.render_empty(1, 1, second);
    EXPECT_NE(first.data, second.data) << "noise";
    EXPECT_EQ(first.width, 160);
    const auto [darkest, lightest] = std::ranges::minmax_element(first.data);
    EXPECT_GT(*darkest, 35) << "no black";
    EXPECT_LT(*lightest, 250);
}

}  // namespace
}  // namespace atrium::calibrate
