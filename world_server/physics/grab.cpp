#include "world_server/physics/grab.hpp"

#include "world_server/physics/bullet_types.hpp"

#include <Eigen/LU>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::physics {
namespace {

Eigen::Vector3d limited(const Eigen::Vector3d& v, double max) {
    const double length = v.norm();
    return length > max ? (v * (max / length)).eval() : v;
}

// The matrix that turns an impulse at `arm` from the centre of mass into that point's velocity.
Eigen::Matrix3d inverse_mass_at(const btRigidBody& body, const Eigen::Vector3d& arm) {
    Eigen::Matrix3d cross;
    cross << 0, -arm.z(), arm.y(), arm.z(), 0, -arm.x(), -arm.y(), arm.x(), 0;
    Eigen::Matrix3d inverse_inertia;
    for (int r = 0; r < 3; ++r) {
        inverse_inertia.row(r) = from_bullet(body.getInvInertiaTensorWorld()[r]).transpose();
    }
    return double(body.getInvMass()) * Eigen::Matrix3d::Identity() -
           cross * inverse_inertia * cross;
}

}  // namespace

Grabs::Grab* Grabs::find(const std::string& holder, std::uint32_t object) {
    for (Grab& grab : grabs_) {
        if (grab.object == object && grab.holder == holder) return &grab;
    }
    return nullptr;
}

int Grabs::patience() const {
    return std::max(1, static_cast<int>(std::lround(options_.patience_s / options_.tick_s)));
}

bool Grabs::hold(const std::string& holder,
                 std::uint32_t object,
                 const Eigen::Vector3d& point_object,
                 const Eigen::Vector3d& goal_world) {
    assert(point_object.allFinite() && goal_world.allFinite());
    if (Grab* held = find(holder, object)) {
        held->point_object = point_object;
        held->goal_world = goal_world;
        held->ticks_left = patience();
        return true;
    }
    const auto of_holder = std::count_if(
        grabs_.begin(), grabs_.end(), [&](const Grab& grab) { return grab.holder == holder; });
    if (grabs_.size() >= options_.max_grabs ||
        static_cast<std::size_t>(of_holder) >= options_.max_per_holder) {
        return false;
    }
    grabs_.push_back({holder, object, point_object, goal_world, patience()});
    return true;
}

bool Grabs::move(const std::string& holder,
                 std::uint32_t object,
                 const Eigen::Vector3d& goal_world) {
    assert(goal_world.allFinite());
    Grab* held = find(holder, object);
    if (held == nullptr) return false;
    held->goal_world = goal_world;
    held->ticks_left = patience();
    return true;
}

bool Grabs::release(const std::string& holder, std::uint32_t object) {
    return std::erase_if(grabs_, [&](const Grab& grab) {
               return grab.object == object && grab.holder == holder;
           }) > 0;
}

void Grabs::release_all(const std::string& holder) {
    std::erase_if(grabs_, [&](const Grab& grab) { return grab.holder == holder; });
}

void Grabs::forget(std::uint32_t object) {
    std::erase_if(grabs_, [&](const Grab& grab) { return grab.object == object; });
}

void Grabs::pull(const Grab& grab, btRigidBody& body) const {
    const btTransform& world_from_body = body.getWorldTransform();
    const Eigen::Vector3d place = from_bullet(world_from_body * to_bullet(grab.point_object));
    const Eigen::Vector3d arm = place - from_bullet(world_from_body.getOrigin());
    const Eigen::Vector3d velocity = from_bullet(body.getVelocityInLocalPoint(to_bullet(arm)));
    const double mass_kg = 1.0 / body.getInvMass();
    const double max_force_n = std::min(options_.max_force_n, mass_kg * options_.max_acceleration);
    // no faster than what the force can bring to rest until the goal, gravity or not
    const Eigen::Vector3d way = grab.goal_world - place;
    const double gravity = from_bullet(body.getGravity()).norm();
    const double braking = std::max(0.5, 0.5 * (max_force_n / mass_kg - gravity));
    const double speed_mps =
        std::min(options_.max_speed_mps, std::sqrt(2.0 * braking * way.norm()));
    const Eigen::Vector3d wanted = limited(options_.follow_hz * way, speed_mps);
    // gravity is applied after this and before the tick's motion
    const Eigen::Vector3d missing =
        wanted - velocity - options_.tick_s * from_bullet(body.getGravity());
    const Eigen::Vector3d impulse =
        limited(inverse_mass_at(body, arm).inverse() * missing, options_.tick_s * max_force_n);
    if (!impulse.allFinite()) return;
    body.activate(true);
    body.applyImpulse(to_bullet(impulse), to_bullet(arm));
    const auto kept = btScalar(std::exp(-options_.spin_damping_hz * options_.tick_s));
    body.setAngularVelocity(kept * body.getAngularVelocity());
}

void Grabs::begin_tick(const std::function<btRigidBody*(std::uint32_t object)>& find) {
    for (Grab& grab : grabs_) {
        btRigidBody* body = --grab.ticks_left >= 0 ? find(grab.object) : nullptr;
        if (body == nullptr || body->getInvMass() == btScalar(0))
            grab.ticks_left = -1;
        else
            pull(grab, *body);
    }
    std::erase_if(grabs_, [](const Grab& grab) { return grab.ticks_left < 0; });
}

}  // namespace atrium::physics
