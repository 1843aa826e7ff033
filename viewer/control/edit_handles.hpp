#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "viewer/control/mouse_grab.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <Eigen/Core>

#include <optional>
#include <string>

namespace atrium::viewer {

enum class HandleMode : std::uint8_t { kMove, kRotate };

/// Which handle: 0, 1, 2 for the axes x, y, z, or the middle, which moves in the plane of the
/// picture.
using Handle = int;
inline constexpr Handle kMiddleHandle = 3;

/// The handles of one object in the picture of one eye: three arrows and a middle, or three rings.
/// Their size in the picture does not depend on the distance.
struct EditHandles {
    HandleMode mode = HandleMode::kMove;
    bool is_local = false;  // axes of the object, else of the world
    geometry::RigidTransform world_from_object{};

    static constexpr double kLength = 0.16;  // of an arrow, share of the picture's height
    static constexpr double kRadius = 0.12;  // of a ring

    Eigen::Vector3d axis(Handle handle) const;
    /// Length in the world of a share of the picture's height, at the object [m].
    double metres(double share, const renderer::EyeView& eye) const;
    /// Handle under the pointer.
    std::optional<Handle> pick(const Pointer& pointer, const renderer::EyeView& eye) const;
    /// Point of a ring [world]; `angle` in rad from a fixed direction.
    Eigen::Vector3d ring_point(Handle handle, double angle, double radius_m) const;
};

/// Pixel of a point in the picture of the eye, y downwards. Empty if it is behind the eye.
std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& p_world,
                                        const renderer::EyeView& eye);
/// Ray through a pixel of the eye's picture.
Ray ray_of(const Eigen::Vector2d& at_px, const renderer::EyeView& eye);

/// Turns the way of the pointer on a handle into a pose.
class HandleDrag {
public:
    HandleDrag(const EditHandles& handles,
               Handle handle,
               const Pointer& pointer,
               const renderer::EyeView& eye);

    /// Pose for the pointer. `snaps`: in steps of 10 cm or 15 degrees.
    geometry::RigidTransform update(const Pointer& pointer,
                                    const renderer::EyeView& eye,
                                    bool snaps);
    /// Restarts from the original pose with another handle of the same kind.
    void constrain(Handle handle, const Pointer& pointer, const renderer::EyeView& eye);
    Handle handle() const { return handle_; }
    const geometry::RigidTransform& start() const { return handles_.world_from_object; }
    /// The way so far, for the picture: "x +0.30 m", "z -45.0 deg".
    const std::string& readout() const { return readout_; }

private:
    void begin(const Pointer& pointer, const renderer::EyeView& eye);
    double along_axis(const Pointer& pointer, const renderer::EyeView& eye) const;
    Eigen::Vector3d in_plane(const Pointer& pointer, const renderer::EyeView& eye) const;
    double angle_about(const Pointer& pointer, const renderer::EyeView& eye) const;
    geometry::RigidTransform moved(const Eigen::Vector3d& way);
    geometry::RigidTransform turned(double angle, bool snaps);

    EditHandles handles_;  // at the start
    Handle handle_;
    double along_m_ = 0.0;                             // at the start, on the axis
    Eigen::Vector3d place_ = Eigen::Vector3d::Zero();  // at the start, in the picture's plane
    bool is_edge_on_ = false;                          // the ring is seen from its side
    Eigen::Vector2d pressed_px_ = Eigen::Vector2d::Zero();
    Eigen::Vector2d tangent_px_ = Eigen::Vector2d::Zero();  // way of the pointer per radian, if so
    double last_angle_ = 0.0;
    double turn_ = 0.0;  // sum over the drag, may exceed a full turn
    std::string readout_;
};

}  // namespace atrium::viewer
