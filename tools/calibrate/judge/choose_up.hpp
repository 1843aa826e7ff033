#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace atrium::calibrate {

/// A direction that may be up, and the cameras that agree with it.
struct UpVote {
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // unit vector in the frame of the cameras
    std::size_t num_level = 0;                      // upright pictures, and cameras that look down
    std::vector<std::size_t> on_side;               // cameras turned by 90 degrees to either side
    std::vector<std::size_t> upside_down;           // cameras turned by 180 degrees
};

struct UpChoice : UpVote {
    double tilt = 0.0;       // mean deviation from level of the cameras that agree, as a sine
    double error_deg = 0.0;  // likely error of `up`, from the scatter of the cameras
    double mean_tilt = 0.0;  // of all cameras; more if some, but not all, are turned
    /// Cameras whose pictures are clearly not level, and by how many degrees.
    std::vector<std::pair<std::size_t, double>> rolled;
    /// Another direction with about as good a vote.
    std::optional<UpVote> rival;
    /// Up if all pictures lie on their side, where they are about as level along that.
    std::optional<Eigen::Vector3d> other_up;
    bool is_known = false;  // false: the cameras are tilted too differently
    std::string axis;       // the axis of the frame that is as good as `up`, for example "+Y"
};
/// Finds the direction along which most cameras are level: upright, or turned by 90, 180 or 270
/// degrees, where upright counts more. A few rolled cameras do not pull it.
UpChoice choose_up(std::span<const geometry::CalibratedCamera> cameras);

}  // namespace atrium::calibrate
