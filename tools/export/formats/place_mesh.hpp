#pragma once

#include "core/geometry/rigid_transform.hpp"

#include <Eigen/Core>

#include <vector>

namespace atrium::exporting {

/// Moves points of the site into the frame of reference of the export.
inline void place(const geometry::RigidTransform& frame_from_site,
                  std::vector<Eigen::Vector3f>& positions) {
    for (Eigen::Vector3f& p : positions) p = (frame_from_site * p.cast<double>()).cast<float>();
}

}  // namespace atrium::exporting
