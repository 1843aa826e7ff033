#pragma once

#include <Eigen/Core>

namespace atrium::physics {

/// An oriented sample of a person's surface that moves from one mesh to the next. World frame.
struct MovingSurfel {
    Eigen::Vector3f position;  // at the capture time of the mesh
    Eigen::Vector3f normal;    // unit length, outwards
    Eigen::Vector3f from;      // on the previous mesh's surface, at the capture time of that mesh
    /// [m/s] of the body part that the surfel belongs to. Smoother than (position - from) / period,
    /// which contains the flicker of the outline.
    Eigen::Vector3f velocity;
};

}  // namespace atrium::physics
