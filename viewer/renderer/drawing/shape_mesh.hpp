#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::renderer {

enum class ShapeKind : std::uint8_t { kBox, kSphere, kCylinder, kCapsule, kPlane };

struct ShapeMesh {
    struct Corner {
        Eigen::Vector3f position_object;  // [m]
        Eigen::Vector3f normal_object;
        /// Texture coordinates: (0, 0) is the top left, (1, 1) the bottom right. The texture
        /// repeats beyond.
        Eigen::Vector2f texture_place = Eigen::Vector2f::Zero();
    };
    std::vector<Corner> corners;
    /// Linear RGB in [0, 1] of each corner, instead of the object's colour; empty: none.
    std::vector<Eigen::Vector3f> colours;
    std::vector<std::uint32_t> indices;  // three per triangle, counter-clockwise from outside
    /// Indices of coarser levels, for small sizes. Empty: there is no coarser level.
    std::array<std::vector<std::uint32_t>, 2> coarser;
};

/// Makes the surface of a shape centred at the origin. `size_m`: full extents; sphere: diameter x;
/// cylinder and capsule: diameter x, height z along local z (a capsule's with its caps); plane:
/// extents x and y, normal +z.
///
/// A texture covers each face of a box once, upright where +z is up. It wraps once around a sphere,
/// a capsule and the side of a cylinder, from the top (+z) to the bottom. It covers each end of a
/// cylinder once. On a plane it repeats once per metre, with its lower left corner at the centre.
ShapeMesh make_shape(ShapeKind kind, const Eigen::Vector3d& size_m);

/// Texture coordinates for a surface without its own: once per metre, projected along the axis
/// nearest to the normal.
Eigen::Vector2f projected_place(const Eigen::Vector3f& position_m, const Eigen::Vector3f& normal);

}  // namespace atrium::renderer
