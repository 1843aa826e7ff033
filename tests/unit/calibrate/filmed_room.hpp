#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "tools/calibrate/board/board_points.hpp"
#include "tools/calibrate/board/detect.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

/// Cameras around a space in which a calibration board is shown to them.
namespace atrium::calibrate_test {

struct ShowOptions {
    std::uint32_t seed = 1;
    std::size_t num_cameras = 4;
    std::uint32_t num_instants = 60;
    double noise_px = 0.15;
    double outliers = 0.01;  // share of the corners, moved by up to 40 px
    double ring = 1.0;       // share of a full circle in which the cameras stand
    double distance_m = 2.2;
    /// The board always faces the first camera, as a beginner holds it.
    bool is_frontal = false;
    double late_instants = 0.0;  // of the last camera
    /// Cameras without a trigger: each picture of each is up to this much early or late.
    double jitter_instants = 0.0;
    double jitter_share = 1.0;  // of the pictures; the others are in time
    /// [instants] The board stays this long in one place. 1: it always moves.
    std::uint32_t rest = 1;
    bool is_last_mirrored = false;  // the pictures of the last camera
};

struct FilmedRoom {
    std::vector<calibrate::Board> boards;
    std::vector<geometry::CalibratedCamera> cameras;  // the truth
    calibrate::BoardPoints points;
    /// Of the first board, per instant.
    std::vector<geometry::RigidTransform> site_from_board;
};

/// A board of 5 x 7 squares, of 60 mm.
calibrate::Board large_board();

FilmedRoom show(const std::vector<calibrate::Board>& boards, const ShowOptions& options);

/// What a camera sees of a board: a ray per pixel, with nine samples each.
calibrate::GrayPicture photograph(const calibrate::Board& board,
                                  const geometry::PinholeCamera& lens,
                                  const geometry::RigidTransform& camera_from_board);

/// RMS of the distances of cameras from the truth, after the rigid motion that fits best [m].
double centres_off_m(const std::vector<geometry::CalibratedCamera>& truth,
                     const std::vector<Eigen::Vector3d>& found);

}  // namespace atrium::calibrate_test
