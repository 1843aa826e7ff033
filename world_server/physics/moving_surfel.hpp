#pragma once

#include <Eigen/Core>

namespace atrium::physics {

/// An oriented sample of a person's surface on its way from one mesh to the next; world frame.
struct MovingSurfel {
    Eigen::Vector3f position;  // where the mesh was captured
    Eigen::Vector3f normal;    // unit length, outwards
    Eigen::Vector3f from;      // where it was when the mesh before was captured, on that surface
    /// [m/s] of the part of the body that it belongs to. Smoother than (position - from) / period,
    /// in which the flicker of the outline is.
    Eigen::Vector3f velocity;
};

}  // namespace atrium::physics
