#pragma once

#include "world_server/physics/surface_index.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <optional>

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

inline std::optional<SurfaceSample> match(const SurfaceIndex& surface,
                                          const Eigen::Vector3f& place,
                                          const Eigen::Vector3f& normal) {
    return surface.nearest(place, kSearchM, [&](const SurfaceSample& candidate) {
        return candidate.normal.dot(normal) > kSameFacing;
    });
}

/// 0: fits; 1: does not.
inline float robust_cost(float distance_m) {
    constexpr float kScaleM = 0.012F;
    const float sq = distance_m * distance_m;
    return sq / (sq + kScaleM * kScaleM);
}

inline bool is_explained_by(const SurfaceIndex& surface, const SurfaceSample& sample) {
    const auto found = match(surface, sample.position, sample.normal);
    return found && std::abs(found->normal.dot(sample.position - found->position)) < kExplainedM;
}

}  // namespace atrium::physics::motion
