#include "world_server/physics/rigid/joint.hpp"

#include "world_server/physics/rigid/bullet_types.hpp"
#include "world_server/physics/rigid/object_body.hpp"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace atrium::physics {
namespace {

constexpr double kMaxCoordinateM = 1000.0;

// A constraint without rows. Springs act by impulses before the step; this only tells Bullet which
// objects sleep and wake together.
class NoConstraint : public btTypedConstraint {
public:
    NoConstraint(btRigidBody& a, btRigidBody& b) : btTypedConstraint(MAX_CONSTRAINT_TYPE, a, b) {}
    void getInfo1(btConstraintInfo1* info) override {
        info->m_numConstraintRows = 0;
        info->nub = 0;
    }
    void getInfo2(btConstraintInfo2*) override {}
    void setParam(int, btScalar, int) override {}
    btScalar getParam(int, int) const override { return 0; }
};

Eigen::Vector3d normal_to(const Eigen::Vector3d& axis) { return axis.unitOrthogonal(); }

// Frame at the anchor. Its axis number `along` (0 for x, 2 for z) is the joint's axis.
geometry::RigidTransform frame_of(const Joint& joint, int along) {
    const Eigen::Vector3d axis = joint.axis.normalized();
    const Eigen::Vector3d second = normal_to(axis);
    Eigen::Matrix3d axes;
    axes.col(along) = axis;
    axes.col((along + 1) % 3) = second;
    axes.col((along + 2) % 3) = axis.cross(second);
    return {Eigen::Quaterniond(axes).normalized(), joint.anchor_m};
}

geometry::RigidTransform body_from_world_at_start(ObjectBody* object) {
    if (object == nullptr) return {};
    return (object->object().world_from_object * object->object_from_body()).inverse();
}

geometry::RigidTransform world_from_body(ObjectBody* object) {
    return object == nullptr ? geometry::RigidTransform{}
                             : from_bullet(object->body().getWorldTransform());
}

Eigen::Vector3d spin_of(ObjectBody* object) {
    return object == nullptr ? Eigen::Vector3d::Zero()
                             : from_bullet(object->body().getAngularVelocity());
}

// Velocity of a body's material at a place in the world.
Eigen::Vector3d velocity_at(ObjectBody* object, const Eigen::Vector3d& place) {
    if (object == nullptr) return Eigen::Vector3d::Zero();
    return from_bullet(
        object->body().getVelocityInLocalPoint(to_bullet((place - object->centre()).eval())));
}

Eigen::Vector3d gravity_of(ObjectBody* object) {
    if (object == nullptr || !object->moves()) return Eigen::Vector3d::Zero();
    return from_bullet(object->body().getGravity());
}

// Change of the velocity along `direction` at `place` per impulse [1/kg].
double inverse_mass_along(ObjectBody* object,
                          const Eigen::Vector3d& place,
                          const Eigen::Vector3d& direction) {
    if (object == nullptr || !object->moves()) return 0.0;
    return object->body().computeImpulseDenominator(to_bullet(place), to_bullet(direction));
}

double inverse_inertia_about(ObjectBody* object, const Eigen::Vector3d& axis) {
    if (object == nullptr || !object->moves()) return 0.0;
    return object->body().computeAngularImpulseDenominator(to_bullet(axis));
}

void push_at(ObjectBody* object, const Eigen::Vector3d& place, const Eigen::Vector3d& impulse) {
    if (object == nullptr || !object->moves() || !object->body().isActive()) return;
    object->body().applyImpulse(to_bullet(impulse), to_bullet((place - object->centre()).eval()));
}

void turn(ObjectBody* object, const Eigen::Vector3d& impulse) {
    if (object == nullptr || !object->moves() || !object->body().isActive()) return;
    object->body().applyTorqueImpulse(to_bullet(impulse));
}

std::unique_ptr<btTypedConstraint> make_hinge(const Joint& joint,
                                              ObjectBody& a,
                                              ObjectBody* b,
                                              double tick_s) {
    const geometry::RigidTransform frame = frame_of(joint, 2);
    const btTransform in_a = to_bullet(body_from_world_at_start(&a) * frame);
    const btTransform in_b = to_bullet(body_from_world_at_start(b) * frame);
    btRigidBody& body_b = b != nullptr ? b->body() : btTypedConstraint::getFixedBody();
    auto hinge = std::make_unique<btHingeConstraint>(a.body(), body_b, in_a, in_b);
    // no bounce at the limits; a lower limit above the upper one means free
    if (joint.limits) {
        hinge->setLimit(btScalar((*joint.limits)[0]),
                        btScalar((*joint.limits)[1]),
                        /*softness=*/btScalar(0.9),
                        /*bias=*/btScalar(0.3),
                        /*relaxation=*/btScalar(0));
    } else {
        hinge->setLimit(btScalar(1), btScalar(-1));
    }
    if (joint.motor_max > 0.0) {
        hinge->enableAngularMotor(
            true, btScalar(joint.motor_speed), btScalar(joint.motor_max * tick_s));
    }
    return hinge;
}

// Bullet measures `b` relative to `a` here, so a and b are swapped. The axis is x.
std::unique_ptr<btGeneric6DofSpring2Constraint> make_general(const Joint& joint,
                                                             ObjectBody& a,
                                                             ObjectBody* b) {
    const geometry::RigidTransform frame = frame_of(joint, 0);
    const btTransform in_a = to_bullet(body_from_world_at_start(&a) * frame);
    const btTransform in_b = to_bullet(body_from_world_at_start(b) * frame);
    btRigidBody& body_b = b != nullptr ? b->body() : btTypedConstraint::getFixedBody();
    return std::make_unique<btGeneric6DofSpring2Constraint>(body_b, a.body(), in_b, in_a, RO_XYZ);
}

std::unique_ptr<btTypedConstraint> make_ball(const Joint& joint, ObjectBody& a, ObjectBody* b) {
    auto ball = make_general(joint, a, b);
    const btVector3 zero(0, 0, 0);
    ball->setLinearLowerLimit(zero);
    ball->setLinearUpperLimit(zero);
    // free if the lower limit is above the upper one
    const auto limit = [&](int axis, const std::optional<double>& angle_rad) {
        ball->setLimit(3 + axis,
                       btScalar(angle_rad ? -*angle_rad : 1.0),
                       btScalar(angle_rad ? *angle_rad : -1.0));
    };
    limit(0, joint.twist_rad);
    limit(1, joint.swing_rad);
    limit(2, joint.swing_rad);
    return ball;
}

std::unique_ptr<btTypedConstraint> make_slider(const Joint& joint, ObjectBody& a, ObjectBody* b) {
    auto slider = make_general(joint, a, b);
    const btVector3 zero(0, 0, 0);
    slider->setAngularLowerLimit(zero);
    slider->setAngularUpperLimit(zero);
    for (int axis = 1; axis < 3; ++axis) slider->setLimit(axis, btScalar(0), btScalar(0));
    slider->setLimit(0,
                     btScalar(joint.limits ? (*joint.limits)[0] : 1.0),
                     btScalar(joint.limits ? (*joint.limits)[1] : -1.0));
    if (joint.motor_max > 0.0) {
        slider->enableMotor(0, true);
        slider->setTargetVelocity(0, btScalar(-joint.motor_speed));  // Bullet's sign is opposite
        slider->setMaxMotorForce(0, btScalar(joint.motor_max));
    }
    return slider;
}

std::unique_ptr<btTypedConstraint> make_constraint(const Joint& joint,
                                                   ObjectBody& a,
                                                   ObjectBody* b,
                                                   double tick_s) {
    switch (joint.kind) {
        case JointKind::kHinge:
            return make_hinge(joint, a, b, tick_s);
        case JointKind::kBall:
            return make_ball(joint, a, b);
        case JointKind::kSlider:
            return make_slider(joint, a, b);
        case JointKind::kSpring:
            break;
    }
    btRigidBody& body_b = b != nullptr ? b->body() : btTypedConstraint::getFixedBody();
    return std::make_unique<NoConstraint>(a.body(), body_b);
}

}  // namespace

std::optional<JointProblem> find_problem(const Joint& joint) {
    using std::numbers::pi;
    const auto is_within = [](double value, double low, double high) {
        return value >= low && value <= high;  // false for NaN
    };
    if (joint.a == 0) return JointProblem{"a", "must be an object"};
    if (joint.a == joint.b) return JointProblem{"b", "must differ from a"};
    if (!is_within(joint.anchor_m.cwiseAbs().maxCoeff(), 0.0, kMaxCoordinateM) ||
        !is_within(joint.anchor_b_m.cwiseAbs().maxCoeff(), 0.0, kMaxCoordinateM)) {
        return JointProblem{"anchor_m", "must be within 1000 m"};
    }
    if (!is_within(joint.axis.norm(), 1e-3, 1e3))
        return JointProblem{"axis", "must be a direction: not all zero"};
    if (joint.limits) {
        const bool is_hinge = joint.kind == JointKind::kHinge;
        const double most = is_hinge ? pi : kMaxCoordinateM;
        const auto& [lower, upper] = *joint.limits;
        if (!(is_within(lower, -most, 0.0) && is_within(upper, 0.0, most))) {
            return is_hinge ? JointProblem{"limits_deg", "must be [-180 to 0, 0 to 180]"}
                            : JointProblem{"limits_m", "must be [-1000 to 0, 0 to 1000]"};
        }
    }
    // beyond 80 degrees, two of the Euler angles coincide
    if (joint.swing_rad && !is_within(*joint.swing_rad, 0.0, 80.001 * pi / 180.0))
        return JointProblem{"swing_deg", "must be 0 to 80"};
    if (joint.twist_rad && !is_within(*joint.twist_rad, 0.0, 170.001 * pi / 180.0))
        return JointProblem{"twist_deg", "must be 0 to 170"};
    if (!is_within(joint.motor_speed, -1e3, 1e3))
        return JointProblem{"motor_speed", "must be -1000 to 1000"};
    if (!is_within(joint.motor_max, 0.0, 1e5))
        return JointProblem{"motor_max", "must be 0 to 100000"};
    if (!is_within(joint.damping, 0.0, 1e5)) return JointProblem{"damping", "must be 0 to 100000"};
    if (!is_within(joint.stiffness_npm, 0.0, 1e6))
        return JointProblem{"stiffness_npm", "must be 0 to 1000000"};
    if (!is_within(joint.rest_length_m, 0.0, kMaxCoordinateM))
        return JointProblem{"rest_length_m", "must be 0 to 1000"};
    if (!is_within(joint.force_max, 0.0, 1e5))
        return JointProblem{"force_max_n", "must be 0 to 100000"};
    return std::nullopt;
}

JointBody::JointBody(const Joint& joint, ObjectBody& a, ObjectBody* b, double tick_s)
    : joint_(joint), a_(a), b_(b), tick_s_(tick_s) {
    assert(!find_problem(joint));
    const geometry::RigidTransform b_from_world = body_from_world_at_start(b);
    const bool is_spring = joint.kind == JointKind::kSpring;
    anchor_in_a_ = body_from_world_at_start(&a) * joint.anchor_m;
    anchor_in_b_ = b_from_world * (is_spring ? joint.anchor_b_m : joint.anchor_m);
    axis_in_b_ = b_from_world.rotation * joint.axis.normalized();
    constraint_ = make_constraint(joint, a, b, tick_s);
}

JointBody::~JointBody() = default;

void JointBody::begin_tick() {
    if (joint_.motor_max > 0.0) a_.body().activate();
    if (joint_.kind == JointKind::kSpring) return pull();
    if (joint_.damping <= 0.0) return;
    if (joint_.kind == JointKind::kSlider) return damp_sliding();
    damp_turning();
}

// Applies the spring's impulse at the end of the tick, including the motion that it causes.
// Implicit: stable for any stiffness.
void JointBody::pull() {
    const Eigen::Vector3d end_a = world_from_body(&a_) * anchor_in_a_;
    const Eigen::Vector3d end_b = world_from_body(b_) * anchor_in_b_;
    const double length = (end_a - end_b).norm();
    if (length < 1e-6) return;
    const Eigen::Vector3d along = (end_a - end_b) / length;
    const double excess = length - joint_.rest_length_m;
    // gravity acts within this tick too; without it a spring would stretch too little
    const double speed = along.dot(velocity_at(&a_, end_a) - velocity_at(b_, end_b) +
                                   tick_s_ * (gravity_of(&a_) - gravity_of(b_)));
    const double inverse_mass =
        inverse_mass_along(&a_, end_a, along) + inverse_mass_along(b_, end_b, along);
    const auto impulse_of = [&](double force, double per_speed) {
        return -tick_s_ * (force + per_speed * speed) / (1.0 + tick_s_ * per_speed * inverse_mass);
    };
    double impulse =
        impulse_of(joint_.stiffness_npm * excess, joint_.stiffness_npm * tick_s_ + joint_.damping);
    const double force =
        joint_.stiffness_npm * (excess + tick_s_ * (speed + inverse_mass * impulse));
    if (joint_.force_max > 0.0 && std::abs(force) > joint_.force_max)
        impulse = impulse_of(std::copysign(joint_.force_max, force), joint_.damping);
    if (joint_.pulls_only && (excess <= 0.0 || impulse >= 0.0)) return;
    push_at(&a_, end_a, impulse * along);
    push_at(b_, end_b, -impulse * along);
}

void JointBody::damp_turning() {
    Eigen::Vector3d spin = spin_of(&a_) - spin_of(b_);
    if (joint_.kind == JointKind::kHinge) {
        const Eigen::Vector3d axis = world_from_body(b_).rotation * axis_in_b_;
        spin = axis * axis.dot(spin);
    }
    const double speed = spin.norm();
    if (speed < 1e-9) return;
    const Eigen::Vector3d axis = spin / speed;
    const double inverse_inertia =
        inverse_inertia_about(&a_, axis) + inverse_inertia_about(b_, axis);
    const double given = tick_s_ * joint_.damping;
    const Eigen::Vector3d impulse = -given * speed / (1.0 + given * inverse_inertia) * axis;
    turn(&a_, impulse);
    turn(b_, -impulse);
}

void JointBody::damp_sliding() {
    const Eigen::Vector3d axis = world_from_body(b_).rotation * axis_in_b_;
    const Eigen::Vector3d place = world_from_body(&a_) * anchor_in_a_;
    const double speed = axis.dot(velocity_at(&a_, place) - velocity_at(b_, place));
    const double inverse_mass =
        inverse_mass_along(&a_, place, axis) + inverse_mass_along(b_, place, axis);
    const double given = tick_s_ * joint_.damping;
    const Eigen::Vector3d impulse = -given * speed / (1.0 + given * inverse_mass) * axis;
    push_at(&a_, place, impulse);
    push_at(b_, place, -impulse);
}

double JointBody::gap_m() const {
    if (joint_.kind == JointKind::kSpring) return 0.0;
    const geometry::RigidTransform from_b = world_from_body(b_);
    Eigen::Vector3d gap = world_from_body(&a_) * anchor_in_a_ - from_b * anchor_in_b_;
    if (joint_.kind == JointKind::kSlider) {
        const Eigen::Vector3d axis = from_b.rotation * axis_in_b_;
        gap -= axis * axis.dot(gap);
    }
    return gap.norm();
}

}  // namespace atrium::physics
