#pragma once

#include "viewer/renderer/view_camera.hpp"

#include <Eigen/Core>

namespace atrium::viewer {

/// What the mouse and the keys did since the last picture.
struct Motion {
    Eigen::Vector2d turn_px = Eigen::Vector2d::Zero();  // dragged with the left button; y downwards
    Eigen::Vector2d pan_px = Eigen::Vector2d::Zero();   // dragged with the right button
    double zoom_steps = 0.0;                            // wheel, positive towards the target
    Eigen::Vector3d fly = Eigen::Vector3d::Zero();      // right, forward, up, each in [-1, 1], for
    double seconds = 0.0;                               // this long
    bool look_around = false;  // turning moves the target around the eye, not the eye around it
    bool walk = false;         // on the floor (z = 0): looks around, goes level
};

/// Moves the viewpoint: orbits around the target, looks around, pans, zooms, flies. The eye stays
/// upright, below the zenith and above the nadir.
renderer::ViewCamera apply(const Motion& motion, const renderer::ViewCamera& camera);

}  // namespace atrium::viewer
