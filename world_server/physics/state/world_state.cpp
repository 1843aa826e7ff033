#include "world_server/physics/state/world_state.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

// Bullet keeps rotations orthonormal up to rounding. A larger error has another source.
constexpr float kRotationTolerance = 1e-3F;

}  // namespace

bool is_valid(const ObjectMotion& motion) {
    const bool is_finite = motion.position_m.allFinite() && motion.rotation.allFinite() &&
                           motion.linear_velocity.allFinite() &&
                           motion.angular_velocity.allFinite() && std::isfinite(motion.idle_s);
    if (!is_finite || motion.activation < ACTIVE_TAG || motion.activation > WANTS_DEACTIVATION) {
        return false;
    }
    const Eigen::Matrix3f product = motion.rotation * motion.rotation.transpose();
    return product.isApprox(Eigen::Matrix3f::Identity(), kRotationTolerance) &&
           motion.rotation.determinant() > 0.0F;
}

bool is_valid(const SoftState& motion) {
    const auto is_finite = [](const Eigen::Vector3f& v) { return v.allFinite(); };
    return motion.positions.size() == motion.velocities.size() &&
           std::all_of(motion.positions.begin(), motion.positions.end(), is_finite) &&
           std::all_of(motion.velocities.begin(), motion.velocities.end(), is_finite);
}

}  // namespace atrium::physics
