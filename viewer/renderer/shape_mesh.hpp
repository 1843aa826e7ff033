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
        /// In the picture that lies on it: (0, 0) is its top left, (1, 1) its bottom right; beyond,
        /// it repeats.
        Eigen::Vector2f texture_place = Eigen::Vector2f::Zero();
    };
    std::vector<Corner> corners;
    std::vector<std::uint32_t> indices;  // three per triangle, counter-clockwise from outside
    /// The same of fewer triangles each, for where it is small; empty: there are not fewer.
    std::array<std::vector<std::uint32_t>, 2> coarser;
};

/// Surface of a shape with its centre at the origin. `size_m`: full extents; a sphere's diameter
/// is x; cylinder and capsule: diameter x, height z along local z (a capsule's with its caps);
/// plane: extents x and y, normal +z.
///
/// A picture lies once on each face of a box, upright where +z is up; once around a sphere, a
/// capsule and the side of a cylinder, from the top (+z) to the bottom; once across each end of a
/// cylinder; on a plane once per metre, its left bottom corner in the middle.
ShapeMesh make_shape(ShapeKind kind, const Eigen::Vector3d& size_m);

/// Where a picture lies on a surface that says nothing of its own: once per metre, seen along the
/// axis that the normal is nearest to.
Eigen::Vector2f projected_place(const Eigen::Vector3f& position_m, const Eigen::Vector3f& normal);

}  // namespace atrium::renderer
