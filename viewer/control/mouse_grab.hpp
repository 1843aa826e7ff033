#pragma once

#include "core/bus/messages.hpp"
#include "viewer/renderer/drawing/shape_mesh.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <Eigen/Core>

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Position of the mouse and state of its left button.
struct Pointer {
    Eigen::Vector2d at_px = Eigen::Vector2d::Zero();  // y downwards
    bool is_down = false;
    int width_px = 1;  // size of the picture
    int height_px = 1;
};

/// Ray in the world; `direction` has length 1.
struct Ray {
    Eigen::Vector3d origin;
    Eigen::Vector3d direction;
};

Ray ray_through(const renderer::ViewCamera& camera, const Pointer& pointer);

/// First hit of a ray.
struct Hit {
    std::uint32_t object = 0;
    double distance_m = 0.0;
    /// Object frame; world frame for a soft object.
    Eigen::Vector3d point_object = Eigen::Vector3d::Zero();
};

/// Intersects the ray with the object's ball, or box around its origin. Empty if it misses.
std::optional<Hit> hit(const Ray& ray,
                       const bus::SceneObject& object,
                       const geometry::RigidTransform& world_from_object);

/// Intersects the ray with the drawn surface of an object with a model, from both sides.
std::optional<Hit> hit(const Ray& ray,
                       std::uint32_t object,
                       const renderer::ShapeMesh& mesh_object,
                       const geometry::RigidTransform& world_from_object);

/// Intersects the ray with a soft object whose nodes are at `nodes` [m, world]: its triangles from
/// both sides, and its segments with some extra radius because ropes are thin.
std::optional<Hit> hit(const Ray& ray,
                       const bus::SoftBody& body,
                       std::span<const Eigen::Vector3f> nodes);

/// Grabs the object under the mouse when the left button is pressed, drags it in the plane through
/// the grabbed point that faces the camera, and releases it with the button.
class MouseGrab {
public:
    using Clock = std::chrono::steady_clock;
    using Pick = std::function<std::optional<Hit>(const Ray&)>;

    explicit MouseGrab(std::string sender) : sender_(std::move(sender)) {}

    /// Returns the commands for the world server: at most one move every 15 ms, and one every half
    /// second without motion, as a sign of life.
    std::vector<bus::SceneCommand> update(const Pointer& pointer,
                                          const renderer::ViewCamera& camera,
                                          const Pick& pick,
                                          Clock::time_point now);
    bool is_holding() const { return held_.has_value(); }

private:
    bus::SceneCommand command(bus::CommandKind kind, const Eigen::Vector3d& goal_world) const;

    std::string sender_;
    std::optional<Hit> held_;
    double depth_m_ = 0.0;  // depth of the plane along the camera's view
    Eigen::Vector3d sent_goal_ = Eigen::Vector3d::Zero();
    Clock::time_point sent_at_;
    bool was_down_ = false;
};

}  // namespace atrium::viewer
