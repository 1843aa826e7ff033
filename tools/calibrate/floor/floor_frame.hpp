#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Marks on the floor, in the frame of the rig that saw them.
struct FloorMarks {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    Eigen::Vector3d on_x = Eigen::Vector3d::Zero();
    bool has_y_side = true;  // false: up is where the cameras are
    Eigen::Vector3d on_y_side = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> on_floor;  // all, three or more, on no line
};

struct FloorOptions {
    double yaw_rad = 0.0;      // from the new +X to `on_x`, counter-clockwise seen from above
    double thickness_m = 0.0;  // of what the marks lie on: the floor is so much lower
};

struct FloorFrame {
    geometry::RigidTransform rig_from_floor;  // the new frame: z = 0 is the floor, +Z is up
    double rms_m = 0.0;                       // of the marks, from their plane
    std::size_t num_below = 0;                // cameras
};

/// The frame that marks on the floor give: the plane nearest to all of them, the origin below
/// `origin`. Errors kInvalidData, with the cure: marks on a line or too near to each other, and a
/// room that is mirrored or upside down, which has most of its cameras below its floor.
Expected<FloorFrame> floor_frame(const FloorMarks& marks,
                                 const std::vector<geometry::CalibratedCamera>& cameras,
                                 const FloorOptions& options);

}  // namespace atrium::calibrate
