#pragma once

#include "core/image/colour_rows.hpp"
#include "viewer/renderer/person_rows.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
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
    std::vector<float> values;  // some more than width x height

    float at(int x, int y) const { return values[place(x, y)]; }
    /// The largest of the 3 x 3 around a pixel that is not at the border: an occluder then counts
    /// up to a pixel beyond its outline, where pictures mix its colour with what lies behind.
    float nearest_around(int x, int y) const {
        float nearest = 0.0f;
        for (int row = y - 1; row <= y + 1; ++row) {
            const float* values_there = values.data() + place(x, row);
            nearest = std::max(nearest, values_there[-1]);
            nearest = std::max(nearest, values_there[0]);
            nearest = std::max(nearest, values_there[1]);
        }
        return nearest;
    }

private:
    std::size_t place(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    }
};

/// Sizes the picture so that its long side is `long_side_px` and a border of a pixel, and fills
/// `corners` with the points' places in it: x and y of `points` are any pixels, z is the inverse
/// depth, and points with 1 / z <= 0 have no part in the size. Returns the picture's pixels per
/// pixel of those. All sets of instructions give the same bits.
float fit_inverse_depth(const Axes& points,
                        int long_side_px,
                        std::vector<Eigen::Vector4f>& corners,
                        InverseDepthPicture& picture,
                        image::RowCode code = image::best_row_code());

/// Draws the triangles that face the camera. `corners` holds one (x, y, 1 / z, unused) per vertex,
/// x and y in pixels of the picture; a triangle with a corner at 1 / z <= 0 (behind the camera) is
/// left out, and so is the rest of a mesh whose triangles have filled the picture fifty times. All
/// sets of instructions give the same bits.
void draw_inverse_depth(std::span<const Eigen::Vector4f> corners,
                        std::span<const std::array<std::uint32_t, 3>> triangles,
                        InverseDepthPicture& picture,
                        image::RowCode code = image::best_row_code());

}  // namespace atrium::renderer
