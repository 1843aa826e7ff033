#pragma once

#include "core/recording/view_path.hpp"
#include "tools/export/formats/frame.hpp"
#include "tools/export/frame_source.hpp"

namespace atrium::exporting {

/// A camera at `position_m` that looks at `target_m`, upright: +X is right, +Y down, +Z forward.
geometry::RigidTransform look_at(const Eigen::Vector3d& position_m,
                                 const Eigen::Vector3d& target_m);

/// The viewer's camera path with a key at each frame. Its times count from `recording_begin`, its
/// places are in the world. Its field of view is that at the first frame.
CameraPath sample_path(const recording::ViewPath& path,
                       const Survey& survey,
                       Timestamp recording_begin,
                       const geometry::RigidTransform& frame_from_world);

}  // namespace atrium::exporting
