#include "world_server/physics/object_body.hpp"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace atrium::physics {
namespace {

constexpr double kMinSizeM = 0.01;
constexpr double kMaxSizeM = 20.0;
constexpr double kMaxMassKg = 10'000.0;
constexpr double kMinDensity = 1.0;       // [kg/m^3] a balloon
constexpr double kMaxDensity = 30'000.0;  // [kg/m^3] denser than any metal in use

btVector3 to_bullet(const Eigen::Vector3d& v) {
    return btVector3(btScalar(v.x()), btScalar(v.y()), btScalar(v.z()));
}
Eigen::Vector3d from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btTransform to_bullet(const geometry::RigidTransform& t) {
    const Eigen::Quaterniond q = t.rotation.normalized();
    return btTransform(
        btQuaternion(btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())),
        to_bullet(t.translation));
}

std::unique_ptr<btCollisionShape> make_shape(const RigidObject& object) {
    const btVector3 size = to_bullet(object.size_m);
    switch (object.shape) {
        case ObjectShape::kSphere:
            return std::make_unique<btSphereShape>(size.x() / 2);
        case ObjectShape::kCylinder: {
            auto shape = std::make_unique<btCylinderShapeZ>(size / 2);
            shape->setSafeMargin(size / 2);
            return shape;
        }
        case ObjectShape::kCapsule:
            return std::make_unique<btCapsuleShapeZ>(size.x() / 2, size.z() - size.x());
        case ObjectShape::kPlane:
            return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
        case ObjectShape::kBox:
            break;
    }
    auto shape = std::make_unique<btBoxShape>(size / 2);
    shape->setSafeMargin(size / 2);
    return shape;
}

double volume_m3(const RigidObject& object) {
    const Eigen::Vector3d& s = object.size_m;
    const double circle = std::numbers::pi / 4.0 * s.x() * s.x();
    switch (object.shape) {
        case ObjectShape::kSphere:
            return circle * s.x() * 2.0 / 3.0;
        case ObjectShape::kCylinder:
            return circle * s.z();
        case ObjectShape::kCapsule:
            return circle * (s.z() - s.x() / 3.0);
        default:
            return s.prod();
    }
}

std::optional<ObjectProblem> find_size_problem(const RigidObject& object) {
    const Eigen::Vector3d& s = object.size_m;
    if (object.shape == ObjectShape::kPlane) return std::nullopt;
    if ((s.array() < kMinSizeM).any() || (s.array() > kMaxSizeM).any()) {
        return ObjectProblem{"size_m", "must be 0.01 m to 20 m"};
    }
    if (object.shape == ObjectShape::kBox) return std::nullopt;
    const double tolerance_m = 1e-6 * s.x();
    if (std::abs(s.x() - s.y()) > tolerance_m) {
        return ObjectProblem{"size_m", "must have one diameter: the first two are equal"};
    }
    if (object.shape == ObjectShape::kSphere && std::abs(s.x() - s.z()) > tolerance_m) {
        return ObjectProblem{"size_m", "must be the diameter thrice for a sphere"};
    }
    if (object.shape == ObjectShape::kCapsule && s.z() < s.x()) {
        return ObjectProblem{"size_m", "must be at least as high as wide for a capsule"};
    }
    return std::nullopt;
}

}  // namespace

std::optional<ObjectProblem> find_problem(const RigidObject& object) {
    const geometry::RigidTransform& pose = object.world_from_object;
    if (!object.size_m.allFinite()) return ObjectProblem{"size_m", "must be finite"};
    if (!pose.translation.allFinite()) return ObjectProblem{"position_m", "must be finite"};
    // written so that NaN fails
    if (!(std::abs(pose.rotation.norm() - 1.0) <= 1e-3)) {
        return ObjectProblem{"rotation", "must be a quaternion of length 1"};
    }
    if (!(object.mass_kg >= 0.0 && object.mass_kg <= kMaxMassKg)) {
        return ObjectProblem{"mass_kg", "must be 0 kg to 10000 kg"};
    }
    if (!(object.friction >= 0.0 && object.friction <= 10.0)) {
        return ObjectProblem{"friction", "must be 0 to 10"};
    }
    if (!(object.restitution >= 0.0 && object.restitution <= 1.0)) {
        return ObjectProblem{"restitution", "must be 0 to 1"};
    }
    if (const auto problem = find_size_problem(object)) return problem;
    if (object.mass_kg == 0.0) return std::nullopt;
    if (object.shape == ObjectShape::kPlane)
        return ObjectProblem{"mass_kg", "must be 0 for a plane"};
    const double density = object.mass_kg / volume_m3(object);
    if (density < kMinDensity || density > kMaxDensity) {
        return ObjectProblem{"mass_kg", "must give a density of 1 to 30000 kg/m^3, or be 0"};
    }
    return std::nullopt;
}

ObjectBody::ObjectBody(const RigidObject& object, const WorldOptions& options)
    : object_(object), inner_radius_m_(0.5 * object.size_m.minCoeff()), shape_(make_shape(object)) {
    assert(!find_problem(object));
    btVector3 inertia(0, 0, 0);
    if (moves()) shape_->calculateLocalInertia(btScalar(object.mass_kg), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(
        btScalar(object.mass_kg), nullptr, shape_.get(), inertia);
    info.m_startWorldTransform = to_bullet(object.world_from_object);
    info.m_friction = btScalar(object.friction);
    info.m_restitution = btScalar(object.restitution);
    // what rolls comes to rest within metres, as on a floor of wood
    info.m_rollingFriction = btScalar(0.0005);
    info.m_spinningFriction = btScalar(0.0005);
    info.m_linearDamping = btScalar(0.02);
    info.m_angularDamping = btScalar(0.1);
    body_ = std::make_unique<btRigidBody>(info);
    body_->setUserPointer(this);
    if (moves()) {
        // sweep what moves further than half its radius in one tick
        const auto radius = btScalar(inner_radius_m_);
        body_->setCcdMotionThreshold(btScalar(0.5) * radius);
        body_->setCcdSweptSphereRadius(btScalar(0.5) * radius);
    }
    assert(options.tick_s > 0.0);
}

ObjectBody::~ObjectBody() = default;

RigidState ObjectBody::state() const {
    const btTransform& transform = body_->getWorldTransform();
    const btQuaternion q = transform.getRotation();
    RigidState state;
    state.id = object_.id;
    state.world_from_object.rotation = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized();
    state.world_from_object.translation = from_bullet(transform.getOrigin());
    state.linear_velocity = from_bullet(body_->getLinearVelocity());
    state.angular_velocity = from_bullet(body_->getAngularVelocity());
    return state;
}

void ObjectBody::put_back() {
    const btTransform start = to_bullet(object_.world_from_object);
    body_->setWorldTransform(start);
    body_->setInterpolationWorldTransform(start);
    const btVector3 zero(0, 0, 0);
    body_->setLinearVelocity(zero);
    body_->setAngularVelocity(zero);
    body_->setInterpolationLinearVelocity(zero);
    body_->setInterpolationAngularVelocity(zero);
    body_->clearForces();
    if (moves()) body_->activate(true);
}

bool ObjectBody::is_finite() const {
    const RigidState s = state();
    return s.world_from_object.translation.allFinite() &&
           s.world_from_object.rotation.coeffs().allFinite() && s.linear_velocity.allFinite() &&
           s.angular_velocity.allFinite();
}

void ObjectBody::limit_motion(const Eigen::Vector3d& position_before, const WorldOptions& options) {
    const auto limited = [](const Eigen::Vector3d& v, double max) -> Eigen::Vector3d {
        return v.norm() > max ? (v * (max / v.norm())).eval() : v;
    };
    const RigidState now = state();
    const Eigen::Vector3d velocity = limited(now.linear_velocity, options.max_speed_mps);
    body_->setLinearVelocity(to_bullet(velocity));
    body_->setAngularVelocity(to_bullet(limited(now.angular_velocity, options.max_spin_rad_s)));

    // what a body moved beyond its velocity is Bullet's way of separating bodies that overlap
    const Eigen::Vector3d flight = options.tick_s * velocity;
    const Eigen::Vector3d correction = now.world_from_object.translation - position_before - flight;
    const double max_correction_m = options.tick_s * options.max_depenetration_mps;
    if (correction.norm() > max_correction_m) {
        btTransform transform = body_->getWorldTransform();
        transform.setOrigin(
            to_bullet((position_before + flight + limited(correction, max_correction_m)).eval()));
        body_->setWorldTransform(transform);
        body_->setInterpolationWorldTransform(transform);
    }
}

}  // namespace atrium::physics
