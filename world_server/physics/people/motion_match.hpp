#pragma once

#include "world_server/physics/options/people_options.hpp"
#include "world_server/physics/people/surface_index.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <span>

// Shared by the source files of the motion estimator.
namespace atrium::physics::motion {

inline Eigen::Array3i cell_at(const Eigen::Vector3f& position, float cell_m) {
    return (position / cell_m).array().floor().cast<int>();
}

/// Finds for each place the nearest sample with a similar normal, or SurfaceIndex::kNone.
inline void match(const SurfaceIndex& surface,
                  std::span<const SurfaceSample> places,
                  const MotionMatchOptions& options,
                  std::span<std::uint32_t> found) {
    surface.nearest(places, options.search_m, options.same_facing, found);
}

/// Signed distance of a place from the surface at a sample, along the sample's normal [m].
inline float distance_along_normal(const SurfaceSample& sample, const Eigen::Vector3f& place) {
    return sample.normal.dot(place - sample.position);
}

/// Robust cost of a distance: 0 for a fit, towards 1 for a mismatch.
inline float robust_cost(float distance_m, float scale_m) {
    const float sq = distance_m * distance_m;
    return sq / (sq + scale_m * scale_m);
}

/// True if a sample, matched at its own position, can be explained without motion.
inline bool is_explained_by(const SurfaceIndex& surface,
                            std::uint32_t matched,
                            const SurfaceSample& sample,
                            float explained_m) {
    return matched != SurfaceIndex::kNone &&
           std::abs(distance_along_normal(surface.samples()[matched], sample.position)) <
               explained_m;
}

}  // namespace atrium::physics::motion
