#pragma once

#include "world_server/physics/people/surface_index.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

// Shared by the source files of the motion estimator.
namespace atrium::physics::motion {

inline constexpr float kSameFacing = 0.6F;  // cosine
inline constexpr float kSearchM = 0.05F;    // search radius around the displaced point
inline constexpr float kExplainedM =
    0.012F;  // a point is explained by rest if its distance along the normal is below this
// largest difference of displacement between parts that move together
inline constexpr float kAlikeM = 0.05F;
inline constexpr std::size_t kTrialPoints = 24;  // points of a region on which a start is tried

inline Eigen::Array3i cell_at(const Eigen::Vector3f& position, float cell_m) {
    return (position / cell_m).array().floor().cast<int>();
}

/// Finds for each place the nearest sample with a similar normal, or SurfaceIndex::kNone.
inline void match(const SurfaceIndex& surface,
                  std::span<const SurfaceSample> places,
                  std::span<std::uint32_t> found) {
    surface.nearest(places, kSearchM, kSameFacing, found);
}

/// Signed distance of a place from the surface at a sample, along the sample's normal [m].
inline float distance_along_normal(const SurfaceSample& sample, const Eigen::Vector3f& place) {
    return sample.normal.dot(place - sample.position);
}

/// Robust cost of a distance: 0 for a fit, towards 1 for a mismatch.
inline float robust_cost(float distance_m) {
    constexpr float kScaleM = 0.012F;
    const float sq = distance_m * distance_m;
    return sq / (sq + kScaleM * kScaleM);
}

/// True if a sample, matched at its own position, can be explained without motion.
inline bool is_explained_by(const SurfaceIndex& surface,
                            std::uint32_t matched,
                            const SurfaceSample& sample) {
    return matched != SurfaceIndex::kNone &&
           std::abs(distance_along_normal(surface.samples()[matched], sample.position)) <
               kExplainedM;
}

}  // namespace atrium::physics::motion
