#pragma once

#include "core/image/colour_rows.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// The inner loops of `build_person_model`, which handle several items at once. All sets of
/// instructions give the same bits.
namespace atrium::renderer {

/// Three numbers per item, each in an array of its own.
struct Axes {
    std::vector<float> x, y, z;

    void resize(std::size_t size) {
        x.resize(size);
        y.resize(size);
        z.resize(size);
    }
    std::size_t size() const { return x.size(); }
};

inline void set(Axes& axes, std::size_t i, const Eigen::Vector3f& value) {
    axes.x[i] = value.x();
    axes.y[i] = value.y();
    axes.z[i] = value.z();
}

/// A camera with the picture that it gave.
struct Projection {
    std::array<float, 9> rotation;  // camera from site, row by row
    std::array<float, 3> translation;
    float fx, fy, cx, cy, skew;
    std::array<float, 5> distortion;
    std::array<float, 2> st_per_px;  // texture coordinates from pixels of the distorted picture
    std::array<float, 2> st_offset;
    std::array<int, 2> layer_size;  // texels that the coordinates span, wide and high
};

struct Projected {
    Axes undistorted;  // pixel and inverse depth; 0 where there is none
    Axes in_layer;     // texture coordinates times depth, and depth; (0, 0, 1) where there are none
    std::vector<std::int32_t> texels;  // number in the layer; of its border for what lies outside
};

/// Points behind the camera, and points farther than 1e6 pixels from the picture, have no place in
/// it.
void project_points(const Projection& camera,
                    const Axes& points,
                    Projected& out,
                    image::RowCode code);

/// Faces by a corner and a unit normal.
struct Faces {
    Axes corners;
    Axes normals;
};

/// Scales vectors to length 1; those of length 0 stay.
void normalize(Axes& vectors, image::RowCode code);

/// How faces are turned to a camera: the cosine between the normal and the way to it, and 0 to 1
/// between the cosines `cos_min` and `cos_full`.
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

/// Vertices that a camera may see: the first `size` of each array.
struct Seen {
    std::size_t size = 0;
    std::vector<std::uint32_t> vertices;
    std::vector<float> cosines;         // of the face of theirs that it sees best
    std::vector<float> inverse_depths;  // [1/m]
    std::vector<float> nearest;         // inverse depth of what is nearest around them
    std::vector<float> masks;           // how surely the mask covers them, in [0, 1]

    void reserve(std::size_t num_vertices);
};

/// How well they are seen: less at a grazing angle, and less behind what is nearer.
struct Seeing {
    Facing facing;
    float hidden_bias_m;  // nothing hides what is less far behind
    float hidden_soft_m;  // over this further distance it fades out
    float pixel_tangent;  // width of a pixel of the nearest depths at a depth of one metre
};
/// Writes the qualities of PersonModel of these vertices, and takes `masks` as its memory.
void judge_seen(const Seeing& seeing, Seen& seen, std::vector<float>& quality, image::RowCode code);

inline constexpr std::uint32_t kOutlineAlpha = 48;

/// One row of a picture, RGBA, of which a pixel shows the person if its alpha is at least 128.
/// Where its four neighbours show her as well the pixel is kept, with alpha 255. Elsewhere its
/// colour is multiplied by kOutlineAlpha / 255, which becomes its alpha. Other pixels become 0. The
/// first and the last pixel have no neighbours, and all pixels of a row without `above` or `below`.
void multiply_by_mask(const std::uint32_t* above,
                      std::span<const std::uint32_t> row,
                      const std::uint32_t* below,
                      std::uint32_t* out,
                      image::RowCode code);

/// Multiplies red, green and blue by factors of at most 100, given in 65536ths.
void multiply_colours(std::span<std::uint32_t> rgba,
                      const std::array<std::uint32_t, 3>& factors,
                      image::RowCode code);

}  // namespace atrium::renderer
