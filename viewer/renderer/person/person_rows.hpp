#pragma once

#include "core/image/axes.hpp"
#include "core/image/colour_rows.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Vectorised inner loops of `build_person_model`. All instruction sets give the same bits.
namespace atrium::renderer {

using image::Axes;

/// Projection of a camera and the mapping to its layer.
struct Projection {
    std::array<float, 9> rotation;  // camera_from_site, row by row
    std::array<float, 3> translation;
    float fx, fy, cx, cy, skew;
    std::array<float, 5> distortion;
    std::array<float, 2> st_per_px;  // texture coordinates from pixels of the distorted picture
    std::array<float, 2> st_offset;
    std::array<int, 2> layer_size;  // texels that the coordinates span, width and height
};

struct Projected {
    Axes undistorted;  // pixel and inverse depth; 0 without a projection
    Axes in_layer;     // (s z, t z, z) as in PersonModel; (0, 0, 1) without a projection
    std::vector<std::int32_t> texels;  // index in the layer, clamped to its border
};

/// Projects the points. Points behind the camera, or more than 1e6 pixels from the picture, have no
/// projection.
void project_points(const Projection& camera,
                    const Axes& points,
                    Projected& out,
                    image::RowCode code);

/// One corner and unit normal per face.
struct Faces {
    Axes corners;
    Axes normals;
};

/// Normalises vectors. Vectors of length 0 stay 0.
void normalize(Axes& vectors, image::RowCode code);

/// Limits of the cosine between the normal and the direction to the camera. `judge_facing` returns
/// that cosine, and a value that rises from 0 to 1 between `cos_min` and `cos_full`.
struct Facing {
    float cos_min;
    float cos_full;
};
void judge_facing(const Faces& faces,
                  const Eigen::Vector3f& centre,
                  const Facing& limits,
                  std::vector<float>& cosines,
                  std::vector<float>& facing,
                  image::RowCode code);

/// Vertices that a camera may see: the first `size` entries of each array.
struct Seen {
    std::size_t size = 0;
    std::vector<std::uint32_t> vertices;
    std::vector<float> cosines;         // of their face that the camera sees best
    std::vector<float> inverse_depths;  // [1/m]
    std::vector<float> nearest;         // largest inverse depth around them
    std::vector<float> masks;           // coverage by the mask, in [0, 1]

    void reserve(std::size_t num_vertices);
};

/// Limits of the quality of vertices: it falls at grazing angles and behind nearer surfaces.
struct Seeing {
    Facing facing;
    float hidden_bias_m;  // a surface this far behind is not hidden
    float hidden_soft_m;  // distance over which it then fades out
    float pixel_tangent;  // pixel width of the depth picture at a depth of one metre
};
/// Writes the qualities of these vertices (PersonModel). Overwrites `masks`.
void judge_seen(const Seeing& seeing, Seen& seen, std::vector<float>& quality, image::RowCode code);

inline constexpr std::uint32_t kOutlineAlpha = 48;

/// Multiplies one row of an RGBA picture by its mask. A pixel shows the person if its alpha is at
/// least 128. Pixels whose four neighbours also show the person keep their colour, with alpha 255.
/// Outline pixels are multiplied by kOutlineAlpha / 255, which becomes their alpha. Other pixels
/// become 0. The first and last pixel, and all pixels of a row without `above` or `below`, count as
/// outline.
void multiply_by_mask(const std::uint32_t* above,
                      std::span<const std::uint32_t> row,
                      const std::uint32_t* below,
                      std::uint32_t* out,
                      image::RowCode code);

/// Multiplies red, green and blue by gains of at most 100, in units of 1/65536.
void multiply_colours(std::span<std::uint32_t> rgba,
                      const std::array<std::uint32_t, 3>& factors,
                      image::RowCode code);

}  // namespace atrium::renderer
