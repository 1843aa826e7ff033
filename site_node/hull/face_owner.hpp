#pragma once

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace atrium::hull {

inline constexpr std::int32_t kNoOwner = -1;

/// The view whose outline made a face of a visual hull: its centre of projection lies in the plane
/// of the face. `corner` is a corner of the face and `normal` its unit normal, in the frame of
/// `centres`. `most_sine` is that of the angle between the face and the ray of its view. Returns
/// the view's index, or kNoOwner for a face that no outline made.
inline std::int32_t face_owner(const Eigen::Vector3d& corner,
                               const Eigen::Vector3d& normal,
                               std::span<const Eigen::Vector3d> centres,
                               double most_sine = 1e-3) {
    double least_sine = most_sine;
    std::int32_t owner = kNoOwner;
    for (std::size_t i = 0; i < centres.size(); ++i) {
        const Eigen::Vector3d ray = corner - centres[i];
        const double sine = std::abs(ray.dot(normal)) / ray.norm();
        if (!(sine < least_sine)) continue;
        least_sine = sine;
        owner = static_cast<std::int32_t>(i);
    }
    return owner;
}

}  // namespace atrium::hull
