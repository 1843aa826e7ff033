#pragma once

#include <Eigen/Core>

namespace atrium::image {

/// How far two colours (Y, U, V) [grey levels] differ. Luma counts less: light differs from side to
/// side, and cameras differ in brightness.
inline float colour_clash(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    constexpr float kOfLuma = 0.4F;
    const Eigen::Vector3f off = (a - b).cwiseAbs();
    return kOfLuma * off.x() + off.y() + off.z();
}

}  // namespace atrium::image
