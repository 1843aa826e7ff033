#pragma once

#include "core/config/rig.hpp"
#include "tools/calibrate/board/board.hpp"
#include "tools/calibrate/board/board_points.hpp"

#include <cstdint>

/// Rooms whose floor is not known yet.
namespace atrium::calibrate_test {

/// A rig whose frame is any, and where the true one is in it.
struct LostRig {
    config::Rig rig;
    geometry::RigidTransform rig_from_site;
};
LostRig lost_rig(std::uint32_t seed);

/// Where a camera sees a point.
Eigen::Vector2d seen_px(const geometry::CalibratedCamera& camera, const Eigen::Vector3d& point_rig);

/// The corners of a board that lies at `site_from_board` for four instants, with noise.
calibrate::BoardPoints lying(const LostRig& lost,
                             const calibrate::Board& board,
                             const geometry::RigidTransform& site_from_board,
                             std::uint32_t seed);

}  // namespace atrium::calibrate_test
