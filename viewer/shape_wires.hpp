#pragma once

#include "core/bus/messages.hpp"
#include "viewer/renderer/overlay.hpp"

#include <Eigen/Core>

#include <vector>

/// Shapes as lines in the world.
namespace atrium::viewer {

void append_line(const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to,
                 const Eigen::Vector3f& colour,
                 std::vector<renderer::Line>& lines);

/// The twelve edges of a box of that size around the origin of its frame.
void append_box(const Eigen::Matrix4d& world_from_box,
                const Eigen::Vector3d& size_m,
                const Eigen::Vector3f& colour,
                std::vector<renderer::Line>& lines);

/// What the physics tests of an object: a sphere as three circles, a cylinder and a capsule as
/// their rims and four lines along them, a plane, which has no end there, as what of it is drawn
/// and its normal. Of a model, whose parts are not known here, its extents; of what is soft
/// nothing.
void append_shape(const bus::SceneObject& object,
                  const Eigen::Matrix4d& world_from_object,
                  const Eigen::Vector3f& colour,
                  std::vector<renderer::Line>& lines);

}  // namespace atrium::viewer
