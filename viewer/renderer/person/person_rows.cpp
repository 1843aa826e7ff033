#include "viewer/renderer/person/person_rows.hpp"

#include <algorithm>
#include <cmath>

#if defined(__x86_64__)
#define ATRIUM_AVX2 __attribute__((target("avx2")))
#endif
#define ATRIUM_INLINE inline __attribute__((always_inline))

namespace atrium::renderer {
namespace {

// The compiler vectorises these loops for each instruction set. None has fused multiply-add, which
// would round differently.

ATRIUM_INLINE void project(const Projection& camera, const Axes& points, Projected& out) {
    constexpr float kNearest = 0.05f;  // [m] nearer points count as behind the camera
    constexpr float kFar_px = 1e6f;    // outside any picture
    const float r0 = camera.rotation[0], r1 = camera.rotation[1], r2 = camera.rotation[2];
    const float r3 = camera.rotation[3], r4 = camera.rotation[4], r5 = camera.rotation[5];
    const float r6 = camera.rotation[6], r7 = camera.rotation[7], r8 = camera.rotation[8];
    const float tx = camera.translation[0], ty = camera.translation[1], tz = camera.translation[2];
    const float k1 = camera.distortion[0], k2 = camera.distortion[1], k3 = camera.distortion[4];
    const float p1 = camera.distortion[2], p2 = camera.distortion[3];
    const float fx = camera.fx, fy = camera.fy, cx = camera.cx, cy = camera.cy;
    const float skew = camera.skew;
    const float s_per_px = camera.st_per_px[0], t_per_px = camera.st_per_px[1];
    const float s_offset = camera.st_offset[0], t_offset = camera.st_offset[1];
    const std::size_t size = points.size();
    const float* px = points.x.data();
    const float* py = points.y.data();
    const float* pz = points.z.data();
    float* out_x = out.undistorted.x.data();
    float* out_y = out.undistorted.y.data();
    float* out_z = out.undistorted.z.data();
    float* out_s = out.in_layer.x.data();
    float* out_t = out.in_layer.y.data();
    float* out_d = out.in_layer.z.data();
    std::int32_t* out_texel = out.texels.data();
    const int stride = camera.layer_size[0];
    const auto layer_width = static_cast<float>(camera.layer_size[0]);
    const auto layer_height = static_cast<float>(camera.layer_size[1]);
    // the arrays do not overlap
#pragma GCC ivdep
    for (std::size_t v = 0; v < size; ++v) {
        const float depth = r6 * px[v] + r7 * py[v] + r8 * pz[v] + tz;
        const float inverse = 1.0f / depth;
        const float x = (r0 * px[v] + r1 * py[v] + r2 * pz[v] + tx) * inverse;
        const float y = (r3 * px[v] + r4 * py[v] + r5 * pz[v] + ty) * inverse;
        const float u = fx * x + skew * y + cx;
        const float w = fy * y + cy;
        // as in PinholeCamera::distort
        const float xx = x * x, yy = y * y, xy = 2.0f * x * y;
        const float rr = xx + yy;
        const float radial = 1.0f + rr * (k1 + rr * (k2 + rr * k3));
        const float bent_x = x * radial + p1 * xy + p2 * (rr + 2.0f * xx);
        const float bent_y = y * radial + p1 * (rr + 2.0f * yy) + p2 * xy;
        const float bent_u = fx * bent_x + skew * bent_y + cx;
        const float bent_w = fy * bent_y + cy;
        // NaN fails these comparisons
        const bool is_near = (depth > kNearest) & (std::abs(u) < kFar_px) &
                             (std::abs(w) < kFar_px) & (std::abs(bent_u) < kFar_px) &
                             (std::abs(bent_w) < kFar_px);
        const float s = bent_u * s_per_px + s_offset;
        const float t = bent_w * t_per_px + t_offset;
        const float texel_x = std::min(std::max(s * layer_width, 0.0f), layer_width - 1.0f);
        const float texel_y = std::min(std::max(t * layer_height, 0.0f), layer_height - 1.0f);
        const int texel = static_cast<int>(is_near ? texel_y : 0.0f) * stride +
                          static_cast<int>(is_near ? texel_x : 0.0f);
        out_x[v] = is_near ? u : 0.0f;
        out_y[v] = is_near ? w : 0.0f;
        out_z[v] = is_near ? inverse : 0.0f;
        out_s[v] = is_near ? s * depth : 0.0f;
        out_t[v] = is_near ? t * depth : 0.0f;
        out_d[v] = is_near ? depth : 1.0f;
        out_texel[v] = texel;
    }
}

ATRIUM_INLINE void scale_to_one(Axes& vectors) {
    float* __restrict xs = vectors.x.data();
    float* __restrict ys = vectors.y.data();
    float* __restrict zs = vectors.z.data();
    for (std::size_t i = 0; i < vectors.size(); ++i) {
        const float x = xs[i], y = ys[i], z = zs[i];
        const float per_length = 1.0f / std::sqrt(x * x + y * y + z * z + 1e-36f);
        xs[i] = x * per_length;
        ys[i] = y * per_length;
        zs[i] = z * per_length;
    }
}

ATRIUM_INLINE void face(const Faces& faces,
                        const Eigen::Vector3f& centre,
                        const Facing& limits,
                        float* __restrict cosines,
                        float* __restrict facing) {
    const float cx = centre.x(), cy = centre.y(), cz = centre.z();
    const float low = limits.cos_min;
    const float per_cos = 1.0f / (limits.cos_full - limits.cos_min);
    const float* __restrict px = faces.corners.x.data();
    const float* __restrict py = faces.corners.y.data();
    const float* __restrict pz = faces.corners.z.data();
    const float* __restrict nx = faces.normals.x.data();
    const float* __restrict ny = faces.normals.y.data();
    const float* __restrict nz = faces.normals.z.data();
    for (std::size_t t = 0; t < faces.corners.size(); ++t) {
        const float x = cx - px[t], y = cy - py[t], z = cz - pz[t];
        const float along = x * nx[t] + y * ny[t] + z * nz[t];
        const float cosine = along / std::sqrt(x * x + y * y + z * z + 1e-30f);
        const float share = std::min(std::max((cosine - low) * per_cos, 0.0f), 1.0f);
        cosines[t] = cosine;
        facing[t] = share * share * (3.0f - 2.0f * share);
    }
}

ATRIUM_INLINE void judge(const Seeing& seeing, Seen& seen) {
    const float low = seeing.facing.cos_min;
    const float per_cos = 1.0f / (seeing.facing.cos_full - seeing.facing.cos_min);
    const float bias_m = seeing.hidden_bias_m;
    const float per_soft = 1.0f / seeing.hidden_soft_m;
    const float bias_per_depth = 1.5f * seeing.pixel_tangent;
    const float* __restrict cosines = seen.cosines.data();
    const float* __restrict inverse_depths = seen.inverse_depths.data();
    const float* __restrict nearest = seen.nearest.data();
    float* __restrict qualities = seen.masks.data();
    for (std::size_t i = 0; i < seen.size; ++i) {
        const float cosine = cosines[i];
        const float share = std::min(std::max((cosine - low) * per_cos, 0.0f), 1.0f);
        const float frontal = share * share * (3.0f - 2.0f * share);
        // slope-scaled bias: a slanted surface is nearer somewhere in the 3 x 3 pixels
        const float slope = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)) / cosine;
        const float depth = 1.0f / inverse_depths[i];
        const float bias = bias_m + bias_per_depth * depth * std::min(slope, 4.0f);
        const float behind = depth - 1.0f / std::max(nearest[i], inverse_depths[i]);
        const float hidden = std::min(std::max((behind - bias) * per_soft, 0.0f), 1.0f);
        qualities[i] = frontal * qualities[i] * (1.0f - hidden);
    }
}

ATRIUM_INLINE std::uint32_t at_outline(std::uint32_t rgba) {
    // two channels in one number; the division by 255 is exact below 65535
    const auto scaled = [](std::uint32_t two) {
        const std::uint32_t v = two * kOutlineAlpha + 0x007f007fU;
        return ((v + 0x00010001U + ((v >> 8U) & 0x00ff00ffU)) >> 8U) & 0x00ff00ffU;
    };
    const std::uint32_t red_blue = scaled(rgba & 0x00ff00ffU);
    const std::uint32_t green = scaled((rgba >> 8U) & 0x000000ffU);
    return red_blue | (green << 8U) | (kOutlineAlpha << 24U);
}

// All ones if the topmost bit of alpha is set.
ATRIUM_INLINE std::uint32_t mask_of(std::uint32_t rgba) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(rgba) >> 31);
}

ATRIUM_INLINE void multiply_row(const std::uint32_t* __restrict above,
                                const std::uint32_t* __restrict row,
                                const std::uint32_t* __restrict below,
                                std::size_t size,
                                std::uint32_t* __restrict out) {
    for (std::size_t x = 1; x + 1 < size; ++x) {
        const std::uint32_t here = row[x];
        const std::uint32_t inside = mask_of(here & row[x - 1] & row[x + 1] & above[x] & below[x]);
        const std::uint32_t masked = mask_of(here);
        out[x] = ((here | 0xff000000U) & inside) | (at_outline(here) & masked & ~inside);
    }
}

ATRIUM_INLINE void multiply_all(std::uint32_t* rgba,
                                std::size_t size,
                                const std::array<std::uint32_t, 3>& factors) {
    const std::uint32_t red = factors[0], green = factors[1], blue = factors[2];
    for (std::size_t i = 0; i < size; ++i) {
        const auto scaled = [](std::uint32_t channel, std::uint32_t factor) {
            return std::min((channel * factor + 0x8000U) >> 16U, 255U);
        };
        const std::uint32_t here = rgba[i];
        rgba[i] = scaled(here & 255U, red) | (scaled((here >> 8U) & 255U, green) << 8U) |
                  (scaled((here >> 16U) & 255U, blue) << 16U) | (here & 0xff000000U);
    }
}

#ifdef ATRIUM_AVX2
ATRIUM_AVX2 void project_avx2(const Projection& camera, const Axes& points, Projected& out) {
    project(camera, points, out);
}
ATRIUM_AVX2 void scale_to_one_avx2(Axes& vectors) { scale_to_one(vectors); }
ATRIUM_AVX2 void face_avx2(const Faces& faces,
                           const Eigen::Vector3f& centre,
                           const Facing& limits,
                           float* cosines,
                           float* facing) {
    face(faces, centre, limits, cosines, facing);
}
ATRIUM_AVX2 void judge_avx2(const Seeing& seeing, Seen& seen) { judge(seeing, seen); }
ATRIUM_AVX2 void multiply_row_avx2(const std::uint32_t* above,
                                   const std::uint32_t* row,
                                   const std::uint32_t* below,
                                   std::size_t size,
                                   std::uint32_t* out) {
    multiply_row(above, row, below, size, out);
}
ATRIUM_AVX2 void multiply_all_avx2(std::uint32_t* rgba,
                                   std::size_t size,
                                   const std::array<std::uint32_t, 3>& factors) {
    multiply_all(rgba, size, factors);
}
#endif

}  // namespace

void project_points(const Projection& camera,
                    const Axes& points,
                    Projected& out,
                    [[maybe_unused]] image::RowCode code) {
    out.undistorted.resize(points.size());
    out.in_layer.resize(points.size());
    out.texels.resize(points.size());
#ifdef ATRIUM_AVX2
    if (code == image::RowCode::kAvx2) return project_avx2(camera, points, out);
#endif
    project(camera, points, out);
}

void normalize(Axes& vectors, [[maybe_unused]] image::RowCode code) {
#ifdef ATRIUM_AVX2
    if (code == image::RowCode::kAvx2) return scale_to_one_avx2(vectors);
#endif
    scale_to_one(vectors);
}

void judge_facing(const Faces& faces,
                  const Eigen::Vector3f& centre,
                  const Facing& limits,
                  std::vector<float>& cosines,
                  std::vector<float>& facing,
                  [[maybe_unused]] image::RowCode code) {
    cosines.resize(faces.corners.size());
    facing.resize(faces.corners.size());
#ifdef ATRIUM_AVX2
    if (code == image::RowCode::kAvx2)
        return face_avx2(faces, centre, limits, cosines.data(), facing.data());
#endif
    face(faces, centre, limits, cosines.data(), facing.data());
}

void Seen::reserve(std::size_t num_vertices) {
    vertices.resize(num_vertices);
    for (std::vector<float>* values : {&cosines, &inverse_depths, &nearest, &masks})
        values->resize(num_vertices);
}

void judge_seen(const Seeing& seeing,
                Seen& seen,
                std::vector<float>& quality,
                [[maybe_unused]] image::RowCode code) {
#ifdef ATRIUM_AVX2
    if (code == image::RowCode::kAvx2)
        judge_avx2(seeing, seen);
    else
#endif
        judge(seeing, seen);
    for (std::size_t i = 0; i < seen.size; ++i) quality[seen.vertices[i]] = seen.masks[i];
}

void multiply_by_mask(const std::uint32_t* above,
                      std::span<const std::uint32_t> row,
                      const std::uint32_t* below,
                      std::uint32_t* out,
                      [[maybe_unused]] image::RowCode code) {
    const auto without_neighbours = [&](std::size_t x) {
        out[x] = at_outline(row[x]) & mask_of(row[x]);
    };
    if (above == nullptr || below == nullptr) {
        for (std::size_t x = 0; x < row.size(); ++x) without_neighbours(x);
        return;
    }
    if (row.empty()) return;
    without_neighbours(0);
    without_neighbours(row.size() - 1);
#ifdef ATRIUM_AVX2
    if (code == image::RowCode::kAvx2)
        return multiply_row_avx2(above, row.data(), below, row.size(), out);
#endif
    multiply_row(above, row.data(), below, row.size(), out);
}

void multiply_colours(std::span<std::uint32_t> rgba,
                      const std::array<std::uint32_t, 3>& factors,
                      [[maybe_unused]] image::RowCode code) {
#ifdef ATRIUM_AVX2
    if (code == image::RowCode::kAvx2) return multiply_all_avx2(rgba.data(), rgba.size(), factors);
#endif
    multiply_all(rgba.data(), rgba.size(), factors);
}

}  // namespace atrium::renderer
