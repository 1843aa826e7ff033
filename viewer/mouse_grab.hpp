#pragma once

#include "core/bus/messages.hpp"
#include "viewer/renderer/view_camera.hpp"

#include <Eigen/Core>

#include <chrono>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Where the mouse points, and whether its left button is down.
struct Pointer {
    Eigen::Vector2d at_px = Eigen::Vector2d::Zero();  // y downwards
    bool is_down = false;
    int width_px = 1;  // of the picture
    int height_px = 1;
};

/// Half a line in the world; `direction` has length 1.
struct Ray {
    Eigen::Vector3d origin;
    Eigen::Vector3d direction;
};

Ray ray_through(const renderer::ViewCamera& camera, const Pointer& pointer);

/// What a ray hits first.
struct Hit {
    std::uint32_t object = 0;
    double distance_m = 0.0;
    Eigen::Vector3d point_object = Eigen::Vector3d::Zero();  // of a soft one in the world
};

/// Where the ray enters the object's box, or ball; nothing: it passes.
std::optional<Hit> hit(const Ray& ray,
                       const bus::SceneObject& object,
                       const geometry::RigidTransform& world_from_object);

/// The same of a soft object whose nodes are at `nodes` [m, world]: its faces from both sides, and
/// what is drawn as a rope with some room around it, as it is thin.
std::optional<Hit> hit(const Ray& ray,
                       const bus::SoftBody& body,
                       std::span<const Eigen::Vector3f> nodes);

/// Takes hold of what the left button is pressed on, pulls it in the plane through that point that
/// faces the camera, and lets go with the button.
class MouseGrab {
public:
    using Clock = std::chrono::steady_clock;
    using Pick = std::function<std::optional<Hit>(const Ray&)>;

    explicit MouseGrab(std::string sender) : sender_(std::move(sender)) {}

    /// What to tell the world server: at most a move every 15 ms, and one every half second even
    /// where nothing moves, so that it knows that somebody still holds on.
    std::vector<bus::SceneCommand> update(const Pointer& pointer,
                                          const renderer::ViewCamera& camera,
                                          const Pick& pick,
                                          Clock::time_point now);
    bool is_holding() const { return held_.has_value(); }

private:
    bus::SceneCommand command(bus::CommandKind kind, const Eigen::Vector3d& goal_world) const;

    std::string sender_;
    std::optional<Hit> held_;
    double depth_m_ = 0.0;  // of the plane, along the camera's view
    Eigen::Vector3d sent_goal_ = Eigen::Vector3d::Zero();
    Clock::time_point sent_at_;
    bool was_down_ = false;
};

}  // namespace atrium::viewer
