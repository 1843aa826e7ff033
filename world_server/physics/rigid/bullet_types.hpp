#pragma once

#include "core/geometry/rigid_transform.hpp"

#include <Eigen/Core>
#include <LinearMath/btTransform.h>

/// Converts between Eigen's types and Bullet's single-precision types.
namespace atrium::physics {

inline btVector3 to_bullet(const Eigen::Vector3d& v) {
    return btVector3(btScalar(v.x()), btScalar(v.y()), btScalar(v.z()));
}

inline btVector3 to_bullet(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

inline Eigen::Vector3f floats_from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Vector3d from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

inline btTransform to_bullet(const geometry::RigidTransform& t) {
    const Eigen::Quaterniond q = t.rotation.normalized();
    return btTransform(
        btQuaternion(btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())),
        to_bullet(t.translation));
}

inline geometry::RigidTransform from_bullet(const btTransform& t) {
    const btQuaternion q = t.getRotation();
    return {Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized(),
            from_bullet(t.getOrigin())};
}

}  // namespace atrium::physics
