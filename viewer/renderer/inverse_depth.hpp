#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::renderer {

/// What a camera sees of a mesh, coarsely: the inverse depth [1/m] of the nearest surface, 0 where
/// there is none.
///
/// Inverse depth, because it is linear in the picture. Row-major, pixel centres at integers.
struct InverseDepthPicture {
    int width = 0;
    int height = 0;
    std::vector<float> values;

    /// Nearest surface in the 3 x 3 pixels around (x, y): an occluder counts up to a pixel beyond
    /// its outline, where pictures mix its colour with what lies behind.
    float nearest_around(float x, float y) const;
};

/// Draws the triangles that face the camera. `corners` holds one (x, y, 1 / z) per vertex, x and y
/// in pixels of the picture; a triangle with a corner at 1 / z <= 0 (behind the camera) is left
/// out, and so is the rest of a mesh whose triangles have filled the picture fifty times.
void draw_inverse_depth(std::span<const Eigen::Vector3f> corners,
                        std::span<const std::array<std::uint32_t, 3>> triangles,
                        InverseDepthPicture& picture);

}  // namespace atrium::renderer
