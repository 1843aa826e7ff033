#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "simulation/person.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::simulation {

constexpr double kAmbient = 0.6;  // ambient light, of a total of about one
constexpr double kDiffuse = 0.4;  // light of the lamp on a surface that faces it

/// An empty room around a rig: matt floor, four walls and ceiling, one soft lamp, and a table if
/// the motion needs one.
struct Room {
    geometry::Aabb walls;
    std::vector<geometry::Aabb> table;  // top, then foot; empty without a table
    Eigen::Vector3d table_axis_x{1.0, 0.0, 0.0};
    Eigen::Vector3d table_centre{0.0, 0.0, 0.0};  // on the floor; origin of the boxes of `table`
    Eigen::Vector3d lamp;
    geometry::CalibratedCamera shadow_camera;  // at the lamp, sees everything in the person's reach

    Eigen::Vector3d table_from_site(const Eigen::Vector3d& p_site) const;
    Eigen::Vector3d site_from_table(const Eigen::Vector3d& p_table) const;
};

Room make_room(std::span<const geometry::CalibratedCamera> cameras, const RoomOptions& options);

/// Returns the corners of the table's triangles [site], three each. Its faces are cut into small
/// triangles, since lens distortion bends straight edges.
std::vector<Eigen::Vector3f> table_triangles(const Room& room);

/// A camera's noise-free picture of the empty room, and how a shadow changes it.
struct RoomView {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> bgr;  // packed
    /// Per pixel: the shadow camera's pixel on the same ray of light.
    std::vector<std::uint32_t> shadow_index;
    /// Fraction of the light that comes from the lamp, 255 = all; 0: never in shadow.
    std::vector<std::uint8_t> shadow_strength;
};

/// Traces four rays through every pixel, with lens distortion.
RoomView view_room(const Room& room,
                   const geometry::PinholeCamera& intrinsics,
                   const geometry::RigidTransform& camera_from_site);

}  // namespace atrium::simulation
