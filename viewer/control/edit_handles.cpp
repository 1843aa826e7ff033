#include "viewer/control/edit_handles.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::viewer {
namespace {

constexpr double kReach = 0.018;  // of the pointer around a handle, share of the picture's height
constexpr double kMiddleReach = 0.025;
constexpr double kNearestM = 0.1;  // of an object from the eye, for the size of its handles
constexpr int kRingPoints = 64;
constexpr double kSnapM = 0.1;
constexpr double kSnapRad = std::numbers::pi / 12.0;
constexpr double kEdgeOn = 0.25;  // cosine between ray and axis below which a ring is a line
constexpr const char* kAxisNames[] = {"x", "y", "z"};

double distance_to_segment(const Eigen::Vector2d& p,
                           const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
    const Eigen::Vector2d way = b - a;
    const double share =
        way.squaredNorm() > 0.0 ? std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0) : 0.0;
    return (a + share * way - p).norm();
}

double snapped(double value, double step, bool snaps) {
    return snaps ? step * std::round(value / step) : value;
}

}  // namespace

std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& p_world,
                                        const renderer::EyeView& eye) {
    const Eigen::Vector4d clip = eye.clip_from_world() * p_world.homogeneous();
    if (clip.w() <= 1e-6) return std::nullopt;
    return Eigen::Vector2d(eye.part_px.width * (0.5 + 0.5 * clip.x() / clip.w()) - 0.5,
                           eye.part_px.height * (0.5 - 0.5 * clip.y() / clip.w()) - 0.5);
}

Ray ray_of(const Eigen::Vector2d& at_px, const renderer::EyeView& eye) {
    const Eigen::Vector2d ndc(2.0 * (at_px.x() + 0.5) / eye.part_px.width - 1.0,
                              1.0 - 2.0 * (at_px.y() + 0.5) / eye.part_px.height);
    const Eigen::Vector4d far =
        eye.clip_from_world().inverse() * Eigen::Vector4d(ndc.x(), ndc.y(), 1.0, 1.0);
    const Eigen::Vector3d origin = eye.eye_world();
    return {origin, (far.head<3>() / far.w() - origin).normalized()};
}

Eigen::Vector3d EditHandles::axis(Handle handle) const {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(handle % 3);
    return is_local ? world_from_object.rotation * unit : unit;
}

double EditHandles::metres(double share, const renderer::EyeView& eye) const {
    const Eigen::Vector4d in_view =
        eye.view_from_world * world_from_object.translation.homogeneous();
    return 2.0 * share * std::max(-in_view.z(), kNearestM) / eye.clip_from_view(1, 1);
}

Eigen::Vector3d EditHandles::ring_point(Handle handle, double angle, double radius_m) const {
    const Eigen::Vector3d a = axis((handle + 1) % 3);
    const Eigen::Vector3d b = axis((handle + 2) % 3);
    return world_from_object.translation + radius_m * (std::cos(angle) * a + std::sin(angle) * b);
}

std::optional<Handle> EditHandles::pick(const Pointer& pointer,
                                        const renderer::EyeView& eye) const {
    const auto middle = pixel_of(world_from_object.translation, eye);
    if (!middle) return std::nullopt;
    const double height = eye.part_px.height;
    if (mode == HandleMode::kMove && (pointer.at_px - *middle).norm() < kMiddleReach * height)
        return kMiddleHandle;
    std::optional<Handle> nearest;
    double least = kReach * height;
    const auto consider = [&](Handle handle, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
        const auto from = pixel_of(a, eye);
        const auto to = pixel_of(b, eye);
        if (!from || !to) return;
        const double distance = distance_to_segment(pointer.at_px, *from, *to);
        if (distance >= least) return;
        least = distance;
        nearest = handle;
    };
    const double length_m = metres(kLength, eye);
    const double radius_m = metres(kRadius, eye);
    for (Handle handle = 0; handle < 3; ++handle) {
        if (mode == HandleMode::kMove) {
            const Eigen::Vector3d& at = world_from_object.translation;
            consider(handle, at, at + length_m * axis(handle));
            continue;
        }
        for (int i = 0; i < kRingPoints; ++i) {
            const double step = 2.0 * std::numbers::pi / kRingPoints;
            consider(handle,
                     ring_point(handle, i * step, radius_m),
                     ring_point(handle, (i + 1) * step, radius_m));
        }
    }
    return nearest;
}

HandleDrag::HandleDrag(const EditHandles& handles,
                       Handle handle,
                       const Pointer& pointer,
                       const renderer::EyeView& eye)
    : handles_(handles), handle_(handle) {
    begin(pointer, eye);
}

void HandleDrag::constrain(Handle handle, const Pointer& pointer, const renderer::EyeView& eye) {
    handle_ = handle;
    // as if the drag had begun with this handle
    Pointer pressed = pointer;
    pressed.at_px = pressed_px_;
    begin(pressed, eye);
}

void HandleDrag::begin(const Pointer& pointer, const renderer::EyeView& eye) {
    pressed_px_ = pointer.at_px;
    turn_ = 0.0;
    if (handles_.mode == HandleMode::kMove) {
        along_m_ = along_axis(pointer, eye);
        place_ = in_plane(pointer, eye);
        return;
    }
    const Ray ray = ray_of(pointer.at_px, eye);
    const Eigen::Vector3d axis = handles_.axis(handle_);
    is_edge_on_ = std::abs(ray.direction.dot(axis)) < kEdgeOn;
    last_angle_ = is_edge_on_ ? 0.0 : angle_about(pointer, eye);
    if (!is_edge_on_) return;
    // the side of the ring that faces the eye
    const Eigen::Vector3d& middle = handles_.world_from_object.translation;
    const Eigen::Vector3d to_eye = eye.eye_world() - middle;
    const Eigen::Vector3d facing = (to_eye - to_eye.dot(axis) * axis).normalized();
    const double radius_m = handles_.metres(EditHandles::kRadius, eye);
    const auto from = pixel_of(middle + radius_m * facing, eye);
    const auto to = pixel_of(middle + radius_m * (facing + 0.01 * axis.cross(facing)), eye);
    tangent_px_ = from && to ? Eigen::Vector2d(100.0 * (*to - *from)) : Eigen::Vector2d(1.0, 0.0);
}

// Place on the axis nearest to the pointer's ray.
double HandleDrag::along_axis(const Pointer& pointer, const renderer::EyeView& eye) const {
    const Ray ray = ray_of(pointer.at_px, eye);
    const Eigen::Vector3d axis = handles_.axis(handle_);
    const Eigen::Vector3d from = handles_.world_from_object.translation - ray.origin;
    const double slope = axis.dot(ray.direction);
    const double spread = std::max(1.0 - slope * slope, 1e-3);  // an axis that points at the eye
    return (slope * from.dot(ray.direction) - from.dot(axis)) / spread;
}

// Where the pointer's ray meets the plane of the picture through the object.
Eigen::Vector3d HandleDrag::in_plane(const Pointer& pointer, const renderer::EyeView& eye) const {
    const Ray ray = ray_of(pointer.at_px, eye);
    const Eigen::Vector3d forward = -eye.view_from_world.row(2).head<3>().transpose();
    const double depth_m = (handles_.world_from_object.translation - ray.origin).dot(forward);
    return ray.origin + depth_m / std::max(ray.direction.dot(forward), 1e-3) * ray.direction;
}

double HandleDrag::angle_about(const Pointer& pointer, const renderer::EyeView& eye) const {
    const Ray ray = ray_of(pointer.at_px, eye);
    const Eigen::Vector3d axis = handles_.axis(handle_);
    const Eigen::Vector3d& middle = handles_.world_from_object.translation;
    const double slope = ray.direction.dot(axis);
    const double distance =
        (middle - ray.origin).dot(axis) / (std::abs(slope) < 1e-3 ? 1e-3 : slope);
    const Eigen::Vector3d arm = ray.origin + distance * ray.direction - middle;
    return std::atan2(arm.dot(handles_.axis((handle_ + 2) % 3)),
                      arm.dot(handles_.axis((handle_ + 1) % 3)));
}

geometry::RigidTransform HandleDrag::update(const Pointer& pointer,
                                            const renderer::EyeView& eye,
                                            bool snaps) {
    if (handles_.mode == HandleMode::kRotate) {
        if (is_edge_on_) {
            const Eigen::Vector2d way = pointer.at_px - pressed_px_;
            turn_ = way.dot(tangent_px_) / std::max(tangent_px_.squaredNorm(), 1.0);
        } else {
            const double angle = angle_about(pointer, eye);
            turn_ += std::remainder(angle - last_angle_, 2.0 * std::numbers::pi);
            last_angle_ = angle;
        }
        return turned(turn_, snaps);
    }
    if (handle_ == kMiddleHandle) {
        Eigen::Vector3d way = in_plane(pointer, eye) - place_;
        for (double& x : way) x = snapped(x, kSnapM, snaps);
        return moved(way);
    }
    const double way_m = snapped(along_axis(pointer, eye) - along_m_, kSnapM, snaps);
    readout_ = fmt::format("{} {:+.3f} m", kAxisNames[handle_], way_m);
    geometry::RigidTransform pose = handles_.world_from_object;
    pose.translation += way_m * handles_.axis(handle_);
    return pose;
}

geometry::RigidTransform HandleDrag::moved(const Eigen::Vector3d& way) {
    readout_ = fmt::format("x {:+.3f}  y {:+.3f}  z {:+.3f} m", way.x(), way.y(), way.z());
    geometry::RigidTransform pose = handles_.world_from_object;
    pose.translation += way;
    return pose;
}

geometry::RigidTransform HandleDrag::turned(double angle, bool snaps) {
    const double turn = snapped(angle, kSnapRad, snaps);
    readout_ =
        fmt::format("{} {:+.1f} deg", kAxisNames[handle_ % 3], turn * 180.0 / std::numbers::pi);
    geometry::RigidTransform pose = handles_.world_from_object;
    pose.rotation = (Eigen::AngleAxisd(turn, handles_.axis(handle_)) * pose.rotation).normalized();
    return pose;
}

}  // namespace atrium::viewer
