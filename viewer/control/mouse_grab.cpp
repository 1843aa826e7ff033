#include "viewer/control/mouse_grab.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::viewer {
namespace {

constexpr std::chrono::milliseconds kMovePeriod{15};
constexpr std::chrono::milliseconds kSignOfLife{500};
constexpr double kRopeReachM = 0.02;  // minimum pick radius around a rope

Eigen::Vector3d forward_of(const renderer::ViewCamera& camera) {
    return (camera.target_m - camera.position_m).normalized();
}

Ray in_frame(const Ray& ray_world, const geometry::RigidTransform& world_from_frame) {
    const geometry::RigidTransform frame_from_world = world_from_frame.inverse();
    return {frame_from_world * ray_world.origin, frame_from_world.rotation * ray_world.direction};
}

// Distance at which the ray enters. Empty if it misses or starts inside.
std::optional<double> enters_box(const Ray& ray, const Eigen::Vector3d& half_m) {
    double enter = 0.0;
    double leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (-half_m[axis] - ray.origin[axis]) / ray.direction[axis];
        const double b = (half_m[axis] - ray.origin[axis]) / ray.direction[axis];
        if (std::isnan(a) || std::isnan(b)) return std::nullopt;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter > 0.0 && enter <= leave ? std::optional(enter) : std::nullopt;
}

std::optional<double> enters_ball(const Ray& ray, double radius_m) {
    const double along = -ray.origin.dot(ray.direction);
    const double inside = radius_m * radius_m - (ray.origin + along * ray.direction).squaredNorm();
    if (inside < 0.0 || along < std::sqrt(inside)) return std::nullopt;
    return along - std::sqrt(inside);
}

// Distance at which the ray meets a triangle, from either side. After: Möller, Trumbore. Fast,
// Minimum Storage Ray/Triangle Intersection. 1997.
std::optional<double> meets_triangle(const Ray& ray,
                                     const Eigen::Vector3d& a,
                                     const Eigen::Vector3d& b,
                                     const Eigen::Vector3d& c) {
    const Eigen::Vector3d across = ray.direction.cross(c - a);
    const double determinant = (b - a).dot(across);
    if (determinant == 0.0) return std::nullopt;
    const Eigen::Vector3d from = ray.origin - a;
    const double u = from.dot(across) / determinant;
    const Eigen::Vector3d up = from.cross(b - a);
    const double v = ray.direction.dot(up) / determinant;
    const double distance = (c - a).dot(up) / determinant;
    const bool is_met = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0;
    return is_met ? std::optional(distance) : std::nullopt;
}

// Distance to the point of the ray nearest to the line from a to b. Empty if it is more than
// `radius_m` away.
std::optional<double> meets_line(const Ray& ray,
                                 const Eigen::Vector3d& a,
                                 const Eigen::Vector3d& b,
                                 double radius_m) {
    const Eigen::Vector3d line = b - a;
    const double turn = line.dot(ray.direction);
    const double slope = line.squaredNorm() - turn * turn;
    const Eigen::Vector3d from = a - ray.origin;
    const double share =
        slope > 0.0
            ? std::clamp((from.dot(ray.direction) * turn - from.dot(line)) / slope, 0.0, 1.0)
            : 0.0;
    const Eigen::Vector3d at = from + share * line;
    const double distance = at.dot(ray.direction);
    const bool is_met = distance > 0.0 && (at - distance * ray.direction).norm() <= radius_m;
    return is_met ? std::optional(distance) : std::nullopt;
}

}  // namespace

Ray ray_through(const renderer::ViewCamera& camera, const Pointer& pointer) {
    const double aspect = static_cast<double>(pointer.width_px) / pointer.height_px;
    const Eigen::Vector2d ndc(2.0 * (pointer.at_px.x() + 0.5) / pointer.width_px - 1.0,
                              1.0 - 2.0 * (pointer.at_px.y() + 0.5) / pointer.height_px);
    const Eigen::Matrix4d clip_from_view = renderer::clip_from_view(camera, aspect);
    const Eigen::Vector3d in_view(
        ndc.x() / clip_from_view(0, 0), ndc.y() / clip_from_view(1, 1), -1.0);
    const Eigen::Matrix3d view_from_world = renderer::view_from_world(camera).topLeftCorner<3, 3>();
    return {camera.position_m, (view_from_world.transpose() * in_view).normalized()};
}

std::optional<Hit> hit(const Ray& ray,
                       const bus::SceneObject& object,
                       const geometry::RigidTransform& world_from_object) {
    const Ray local = in_frame(ray, world_from_object);
    const auto distance = object.shape == bus::Shape::kSphere
                              ? enters_ball(local, 0.5 * object.size_m.x())
                              : enters_box(local, 0.5 * object.size_m);
    if (!distance) return std::nullopt;
    return Hit{object.object, *distance, local.origin + *distance * local.direction};
}

std::optional<Hit> hit(const Ray& ray,
                       std::uint32_t object,
                       const renderer::ShapeMesh& mesh_object,
                       const geometry::RigidTransform& world_from_object) {
    const Ray local = in_frame(ray, world_from_object);
    const auto at = [&](std::size_t i) {
        return mesh_object.corners[mesh_object.indices[i]].position_object.cast<double>().eval();
    };
    std::optional<double> nearest;
    for (std::size_t i = 0; i + 2 < mesh_object.indices.size(); i += 3) {
        const auto distance = meets_triangle(local, at(i), at(i + 1), at(i + 2));
        if (distance && (!nearest || *distance < *nearest)) nearest = distance;
    }
    if (!nearest) return std::nullopt;
    return Hit{object, *nearest, local.origin + *nearest * local.direction};
}

std::optional<Hit> hit(const Ray& ray,
                       const bus::SoftBody& body,
                       std::span<const Eigen::Vector3f> nodes) {
    if (nodes.size() != body.num_nodes) return std::nullopt;
    const auto at = [&](std::uint16_t node) { return nodes[node].cast<double>().eval(); };
    std::optional<double> nearest;
    const auto consider = [&](const std::optional<double>& distance) {
        if (distance && (!nearest || *distance < *nearest)) nearest = distance;
    };
    for (const auto& [a, b, c] : body.triangles) consider(meets_triangle(ray, at(a), at(b), at(c)));
    const double radius_m = std::max(kRopeReachM, 0.5 * body.thickness_m);
    for (const auto& [a, b] : body.segments) consider(meets_line(ray, at(a), at(b), radius_m));
    if (!nearest) return std::nullopt;
    return Hit{body.object, *nearest, ray.origin + *nearest * ray.direction};
}

bus::SceneCommand MouseGrab::command(bus::CommandKind kind,
                                     const Eigen::Vector3d& goal_world) const {
    bus::SceneCommand command;
    command.sender = sender_;
    command.kind = kind;
    command.target = held_->object;
    command.point_object = held_->point_object;
    command.goal_world = goal_world;
    return command;
}

std::vector<bus::SceneCommand> MouseGrab::update(const Pointer& pointer,
                                                 const renderer::ViewCamera& camera,
                                                 const Pick& pick,
                                                 Clock::time_point now) {
    std::vector<bus::SceneCommand> commands;
    const bool is_pressed = pointer.is_down && !was_down_;
    was_down_ = pointer.is_down;
    const Ray ray = ray_through(camera, pointer);
    const Eigen::Vector3d forward = forward_of(camera);
    if (is_pressed) {
        held_ = pick(ray);
        if (!held_) return commands;
        depth_m_ = held_->distance_m * ray.direction.dot(forward);
    }
    if (!held_) return commands;
    const Eigen::Vector3d goal = ray.origin + depth_m_ / ray.direction.dot(forward) * ray.direction;
    const bool is_news = goal != sent_goal_ && now - sent_at_ >= kMovePeriod;
    if (!pointer.is_down) {
        commands.push_back(command(bus::CommandKind::kRelease, goal));
        held_.reset();
    } else if (is_pressed || is_news || now - sent_at_ >= kSignOfLife) {
        commands.push_back(
            command(is_pressed ? bus::CommandKind::kGrab : bus::CommandKind::kMove, goal));
        sent_goal_ = goal;
        sent_at_ = now;
    }
    return commands;
}

}  // namespace atrium::viewer
