#pragma once

#include "core/image/axes.hpp"
#include "core/image/colour_rows.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::image {

/// A coarse depth picture of a mesh: the inverse depth [1/m] of the nearest surface, 0 where there
/// is none.
///
/// Inverse depth is linear in the picture. Row-major, pixel centres at integers.
struct InverseDepthPicture {
    int width = 0;
    int height = 0;
    float scale = 1.0f;  // pixels of it per pixel that it has been fitted to
    Eigen::Vector2f origin_px = Eigen::Vector2f::Zero();  // the latter, at its pixel (0, 0)
    std::vector<float> values;                            // slightly more than width x height

    float at(int x, int y) const { return values[place(x, y)]; }
    /// Where it shows a pixel of those that it has been fitted to.
    Eigen::Vector2f place_of(const Eigen::Vector2f& px) const { return (px - origin_px) * scale; }
    /// Largest value of the 3 x 3 pixels around an inner pixel. It extends an occluder by one
    /// pixel, where the camera pictures mix its colour with the background.
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

/// Scales the points into a depth picture and sets its size: the long side is `long_side_px` plus a
/// border of one pixel. Writes the points' positions in it to `corners`. x and y of `points` are
/// pixels of any picture and z is the inverse depth; points with z <= 0 do not affect the size.
/// All instruction sets give the same bits.
void fit_inverse_depth(const Axes& points,
                       int long_side_px,
                       std::vector<Eigen::Vector4f>& corners,
                       InverseDepthPicture& picture,
                       RowCode code = best_row_code());

/// Rasterises the triangles that face the camera. `corners` has one (x, y, inverse depth, unused)
/// per vertex, x and y in pixels of the picture. Skips triangles with a corner behind the camera
/// (inverse depth <= 0), and the rest of the mesh once its triangles have covered the picture fifty
/// times. All instruction sets give the same bits.
void draw_inverse_depth(std::span<const Eigen::Vector4f> corners,
                        std::span<const std::array<std::uint32_t, 3>> triangles,
                        InverseDepthPicture& picture,
                        RowCode code = best_row_code());

}  // namespace atrium::image
