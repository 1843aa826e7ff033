#pragma once

#include "viewer/renderer/drawing/view_camera.hpp"

#include <Eigen/Core>

namespace atrium::viewer {

/// Input of mouse and keys since the last picture.
struct Motion {
    Eigen::Vector2d turn_px = Eigen::Vector2d::Zero();  // dragged with the left button; y downwards
    Eigen::Vector2d pan_px = Eigen::Vector2d::Zero();   // dragged with the right button
    double zoom_steps = 0.0;                            // wheel, positive towards the target
    /// Speed to the right, forward and up, each in [-1, 1], during `seconds`.
    Eigen::Vector3d fly = Eigen::Vector3d::Zero();
    double seconds = 0.0;  // [s]
    /// Turning moves the target around the eye instead of the eye around the target.
    bool look_around = false;
    bool walk = false;  // on the floor (z = 0): looks around, moves horizontally
};

/// Moves the viewpoint: orbits around the target, looks around, pans, zooms, flies or walks. The
/// eye stays upright, below the zenith and above the nadir. Orbit, zoom and pan keep it above the
/// floor (z = 0), wherever the target is: an orbit slides along the floor, and zooming towards a
/// target below the floor stops there. Only flying crosses the floor.
renderer::ViewCamera apply(const Motion& motion, const renderer::ViewCamera& camera);

}  // namespace atrium::viewer
