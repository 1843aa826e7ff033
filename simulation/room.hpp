#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "simulation/person.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::simulation {

constexpr double kAmbient = 0.6;  // light from everywhere, of a total of about one
constexpr double kDiffuse = 0.4;  // light of the lamp on a surface that faces it

/// An empty room around a rig: floor, four walls and a ceiling, all matt, one soft lamp; a table
/// where the motion has one.
struct Room {
    geometry::Aabb walls;
    std::vector<geometry::Aabb> table;  // its top, then its foot; empty without a table
    Eigen::Vector3d table_axis_x{1.0, 0.0, 0.0};
    Eigen::Vector3d table_centre{
        0.0, 0.0, 0.0};  // on the floor; the boxes of `table` are relative to it
    Eigen::Vector3d lamp;
    geometry::CalibratedCamera
        shadow_camera;  // stands at the lamp and sees all that the person can reach

    Eigen::Vector3d table_from_site(const Eigen::Vector3d& p_site) const;
    Eigen::Vector3d site_from_table(const Eigen::Vector3d& p_table) const;
};

Room make_room(std::span<const geometry::CalibratedCamera> cameras, const RoomOptions& options);

/// Corners of the table's triangles [site], three each: its faces cut into small ones, for lens
/// distortion bends straight edges.
std::vector<Eigen::Vector3f> table_triangles(const Room& room);

/// What a camera sees of the empty room, before noise, and how a shadow would change it.
struct RoomView {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> bgr;  // packed
    std::vector<std::uint32_t>
        shadow_index;  // per pixel: the pixel of the shadow camera on the same ray of light
    std::vector<std::uint8_t>
        shadow_strength;  // share of the light that the lamp gives, 255 = all; 0: never shadowed
};

/// Follows four rays through every pixel, lens distortion included.
RoomView view_room(const Room& room,
                   const geometry::PinholeCamera& intrinsics,
                   const geometry::RigidTransform& camera_from_site);

}  // namespace atrium::simulation
