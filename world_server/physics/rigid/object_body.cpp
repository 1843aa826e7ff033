#include "world_server/physics/rigid/object_body.hpp"

#include "world_server/physics/rigid/bullet_types.hpp"

#include <btBulletDynamicsCommon.h>

#include <cassert>

namespace atrium::physics {
namespace {

btVector3 limited(const btVector3& v, btScalar most) {
    const btScalar length = v.length();
    return length > most ? btVector3(v * (most / length)) : v;
}

}  // namespace

ObjectBody::ObjectBody(const RigidObject& object, const WorldOptions& options)
    : object_(object), shape_(object, options.rigid.hull), inertia_(shape_.inertia()) {
    btRigidBody::btRigidBodyConstructionInfo info(
        btScalar(object.mass_kg), nullptr, &shape_.shape(), to_bullet(shape_.inertia()));
    info.m_startWorldTransform = start();
    info.m_friction = btScalar(object.friction);
    info.m_restitution = btScalar(object.restitution);
    info.m_rollingFriction = btScalar(object.rolling_friction_m);
    info.m_spinningFriction = btScalar(object.rolling_friction_m);
    info.m_linearDamping = btScalar(object.drag_per_s);
    info.m_angularDamping = btScalar(0.1);
    body_ = std::make_unique<btRigidBody>(info);
    body_->setUserPointer(this);
    body_->setSleepingThresholds(options.rigid.sleep_mps, options.rigid.sleep_rad_s);
    if (moves()) {
        // continuous collision for motion of more than half the radius per tick
        const auto radius = btScalar(inner_radius_m());
        body_->setCcdMotionThreshold(btScalar(0.5) * radius);
        body_->setCcdSweptSphereRadius(btScalar(0.5) * radius);
    }
    assert(options.tick_s > 0.0);
}

ObjectBody::~ObjectBody() = default;

btTransform ObjectBody::start() const {
    return to_bullet(object_.world_from_object * shape_.object_from_body());
}

// Derives the object's pose from the body's. The velocity is that of the object's origin.
RigidState ObjectBody::state() const {
    const geometry::RigidTransform world_from_body = from_bullet(body_->getWorldTransform());
    RigidState state;
    state.id = object_.id;
    state.world_from_object = world_from_body * shape_.object_from_body().inverse();
    state.angular_velocity = from_bullet(body_->getAngularVelocity());
    const Eigen::Vector3d from_centre =
        state.world_from_object.translation - world_from_body.translation;
    state.linear_velocity =
        from_bullet(body_->getLinearVelocity()) + state.angular_velocity.cross(from_centre);
    return state;
}

void ObjectBody::set_state(const RigidState& state) {
    const geometry::RigidTransform world_from_body =
        state.world_from_object * shape_.object_from_body();
    const Eigen::Vector3d from_centre =
        state.world_from_object.translation - world_from_body.translation;
    move_to(to_bullet(world_from_body),
            to_bullet((state.linear_velocity - state.angular_velocity.cross(from_centre)).eval()),
            to_bullet(state.angular_velocity));
}

void ObjectBody::set_material(double mass_kg, double friction, double restitution) {
    assert((mass_kg > 0.0) == moves());
    if (moves()) {
        const double ratio = mass_kg / object_.mass_kg;
        inertia_ *= ratio;
        body_->setMassProps(btScalar(mass_kg), to_bullet(inertia_));
        body_->updateInertiaTensor();
    }
    body_->setFriction(btScalar(friction));
    body_->setRestitution(btScalar(restitution));
    object_.mass_kg = mass_kg;
    object_.friction = friction;
    object_.restitution = restitution;
}

Eigen::Vector3d ObjectBody::centre() const {
    return from_bullet(body_->getWorldTransform().getOrigin());
}

void ObjectBody::reset_to_start() {
    const btVector3 zero(0, 0, 0);
    move_to(start(), zero, zero);
}

void ObjectBody::move_to(const btTransform& world_from_body,
                         const btVector3& linear_velocity,
                         const btVector3& angular_velocity) {
    body_->setWorldTransform(world_from_body);
    body_->setInterpolationWorldTransform(world_from_body);
    body_->setLinearVelocity(linear_velocity);
    body_->setAngularVelocity(angular_velocity);
    body_->setInterpolationLinearVelocity(linear_velocity);
    body_->setInterpolationAngularVelocity(angular_velocity);
    body_->clearForces();
    if (moves()) body_->activate(true);
}

bool ObjectBody::is_finite() const {
    // check Bullet's matrix: the conversion to a quaternion can hide NaN
    const btTransform& t = body_->getWorldTransform();
    Eigen::Matrix<double, 18, 1> all;
    for (int i = 0; i < 3; ++i) {
        all.segment<3>(3 * i) = from_bullet(t.getBasis()[i]);
    }
    all.segment<3>(9) = from_bullet(t.getOrigin());
    all.segment<3>(12) = from_bullet(body_->getLinearVelocity());
    all.segment<3>(15) = from_bullet(body_->getAngularVelocity());
    return all.allFinite();
}

void ObjectBody::limit_speeds(const WorldOptions& options) {
    const btVector3& velocity = body_->getLinearVelocity();
    const btVector3& spin = body_->getAngularVelocity();
    body_->setLinearVelocity(limited(velocity, btScalar(options.max_speed_mps)));
    body_->setAngularVelocity(limited(spin, btScalar(options.max_spin_rad_s)));
}

void ObjectBody::limit_depenetration(const Eigen::Vector3d& centre_before,
                                     const WorldOptions& options) {
    // motion beyond the velocity is Bullet's depenetration
    const btVector3 flight = limited(body_->getLinearVelocity(), btScalar(options.max_speed_mps)) *
                             btScalar(options.tick_s);
    const btVector3 expected = to_bullet(centre_before) + flight;
    const btVector3 correction = to_bullet(centre()) - expected;
    const btScalar most = btScalar(options.tick_s * options.max_depenetration_mps);
    if (!(correction.length() > most)) return;
    btTransform transform = body_->getWorldTransform();
    transform.setOrigin(expected + limited(correction, most));
    body_->setWorldTransform(transform);
    body_->setInterpolationWorldTransform(transform);
}

}  // namespace atrium::physics
