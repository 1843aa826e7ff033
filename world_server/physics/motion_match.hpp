#pragma once

#include "world_server/physics/surface_index.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

// What the parts of the motion estimate share.
namespace atrium::physics::motion {

inline constexpr float kSameFacing = 0.6F;  // cosine
inline constexpr float kSearchM = 0.05F;    // around the place that a displacement gives
inline constexpr float kExplainedM =
    0.012F;  // along the normal: closer than this, rest explains a point
inline constexpr float kAlikeM = 0.05F;  // difference of displacement of parts that move together
inline constexpr std::size_t kTrialPoints = 24;  // of a region that a start is tried on

inline Eigen::Array3i cell_at(const Eigen::Vector3f& position, float cell_m) {
    return (position / cell_m).array().floor().cast<int>();
}

/// For each place the nearest sample that faces the same way, or SurfaceIndex::kNone.
inline void match(const SurfaceIndex& surface,
                  std::span<const SurfaceSample> places,
                  std::span<std::uint32_t> found) {
    surface.nearest(places, kSearchM, kSameFacing, found);
}

/// Of a place from the surface at a sample, along its normal [m].
inline float distance_along_normal(const SurfaceSample& sample, const Eigen::Vector3f& place) {
    return sample.normal.dot(place - sample.position);
}

/// 0: fits; 1: does not.
inline float robust_cost(float distance_m) {
    constexpr float kScaleM = 0.012F;
    const float sq = distance_m * distance_m;
    return sq / (sq + kScaleM * kScaleM);
}

/// Whether rest explains a sample that was matched where it is.
inline bool is_explained_by(const SurfaceIndex& surface,
                            std::uint32_t matched,
                            const SurfaceSample& sample) {
    return matched != SurfaceIndex::kNone &&
           std::abs(distance_along_normal(surface.samples()[matched], sample.position)) <
               kExplainedM;
}

}  // namespace atrium::physics::motion
