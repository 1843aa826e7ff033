#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace atrium::renderer {

enum class ShapeKind : std::uint8_t { kBox, kSphere, kCylinder, kCapsule, kPlane };

struct ShapeMesh {
    struct Corner {
        Eigen::Vector3f position_object;  // [m]
        Eigen::Vector3f normal_object;
    };
    std::vector<Corner> corners;
    std::vector<std::uint32_t> indices;  // three per triangle, counter-clockwise from outside
};

/// Surface of a shape with its centre at the origin. `size_m`: full extents; a sphere's diameter
/// is x; cylinder and capsule: diameter x, height z along local z (a capsule's with its caps);
/// plane: extents x and y, normal +z.
ShapeMesh make_shape(ShapeKind kind, const Eigen::Vector3d& size_m);

}  // namespace atrium::renderer
