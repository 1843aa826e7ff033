#pragma once

#include "core/bus/messages.hpp"
#include "viewer/renderer/overlay.hpp"

#include <Eigen/Core>

#include <vector>

/// Draws collision shapes as lines in the world.
namespace atrium::viewer {

void append_line(const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to,
                 const Eigen::Vector3f& colour,
                 std::vector<renderer::Line>& lines);

/// Appends the twelve edges of a box of that size, centred at the origin of its frame.
void append_box(const Eigen::Matrix4d& world_from_box,
                const Eigen::Vector3d& size_m,
                const Eigen::Vector3f& colour,
                std::vector<renderer::Line>& lines);

/// Appends the collision shape of an object: a sphere as three circles, a cylinder or capsule as
/// its rims and four lines along it, a plane as its drawn rectangle and its normal. Appends the
/// bounding box for a model, whose parts are not known here, and nothing for a soft object.
void append_shape(const bus::SceneObject& object,
                  const Eigen::Matrix4d& world_from_object,
                  const Eigen::Vector3f& colour,
                  std::vector<renderer::Line>& lines);

}  // namespace atrium::viewer
