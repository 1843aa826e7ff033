#include "world_server/physics/grab.hpp"

#include "world_server/physics/rigid/bullet_types.hpp"
#include "world_server/physics/soft/soft_body.hpp"

#include <Eigen/LU>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace atrium::physics {
namespace {

Eigen::Vector3d limited(const Eigen::Vector3d& v, double max) {
    const double length = v.norm();
    return length > max ? (v * (max / length)).eval() : v;
}

// Maps an impulse at `arm` from the centre of mass to the velocity of that point.
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

int Grabs::timeout_ticks() const {
    return std::max(1, static_cast<int>(std::lround(options_.timeout_s / options_.tick_s)));
}

bool Grabs::hold(Grab grab) {
    assert(grab.goal_world.allFinite());
    grab.ticks_left = timeout_ticks();
    if (Grab* held = find(grab.holder, grab.object)) {
        *held = std::move(grab);
        return true;
    }
    const auto of_holder = std::count_if(grabs_.begin(), grabs_.end(), [&](const Grab& other) {
        return other.holder == grab.holder;
    });
    if (grabs_.size() >= options_.max_grabs ||
        static_cast<std::size_t>(of_holder) >= options_.max_per_holder) {
        return false;
    }
    grabs_.push_back(std::move(grab));
    return true;
}

bool Grabs::hold(const std::string& holder,
                 std::uint32_t object,
                 const Eigen::Vector3d& point_object,
                 const Eigen::Vector3d& goal_world) {
    assert(point_object.allFinite());
    Grab grab;
    grab.holder = holder;
    grab.object = object;
    grab.point_object = point_object;
    grab.goal_world = goal_world;
    return hold(std::move(grab));
}

bool Grabs::hold(const std::string& holder,
                 std::uint32_t object,
                 const SoftHandle& handle,
                 const Eigen::Vector3d& goal_world) {
    assert(!handle.nodes.empty());
    Grab grab;
    grab.holder = holder;
    grab.object = object;
    grab.handle = handle;
    grab.goal_world = goal_world;
    return hold(std::move(grab));
}

bool Grabs::move(const std::string& holder,
                 std::uint32_t object,
                 const Eigen::Vector3d& goal_world) {
    assert(goal_world.allFinite());
    Grab* held = find(holder, object);
    if (held == nullptr) return false;
    held->goal_world = goal_world;
    held->ticks_left = timeout_ticks();
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

double Grabs::max_force_n(double mass_kg) const {
    return std::min(options_.max_force_n, mass_kg * options_.max_acceleration);
}

// Wanted velocity of the held point, `way` [m] from its goal: no faster than the force can stop
// within that distance, against gravity too.
Eigen::Vector3d Grabs::wanted_velocity(const Eigen::Vector3d& way,
                                       double mass_kg,
                                       double gravity) const {
    const double braking = std::max(0.5, 0.5 * (max_force_n(mass_kg) / mass_kg - gravity));
    const double speed_mps =
        std::min(options_.max_speed_mps, std::sqrt(2.0 * braking * way.norm()));
    return limited(options_.follow_hz * way, speed_mps);
}

void Grabs::pull(const Grab& grab, SoftBody& soft, double gravity) const {
    const double mass_kg = soft.object().mass_kg;
    const Eigen::Vector3d place = from_bullet(place_of(soft.body(), grab.handle));
    const Eigen::Vector3d wanted = wanted_velocity(grab.goal_world - place, mass_kg, gravity);
    if (!wanted.allFinite()) return;
    soft.drive(grab.handle, to_bullet(wanted), btScalar(max_force_n(mass_kg)));
}

void Grabs::pull(const Grab& grab, btRigidBody& body) const {
    const btTransform& world_from_body = body.getWorldTransform();
    const Eigen::Vector3d place = from_bullet(world_from_body * to_bullet(grab.point_object));
    const Eigen::Vector3d arm = place - from_bullet(world_from_body.getOrigin());
    const Eigen::Vector3d velocity = from_bullet(body.getVelocityInLocalPoint(to_bullet(arm)));
    const double mass_kg = 1.0 / body.getInvMass();
    const Eigen::Vector3d wanted =
        wanted_velocity(grab.goal_world - place, mass_kg, from_bullet(body.getGravity()).norm());
    // Bullet applies gravity later in this tick
    const Eigen::Vector3d missing =
        wanted - velocity - options_.tick_s * from_bullet(body.getGravity());
    const Eigen::Vector3d impulse = limited(inverse_mass_at(body, arm).inverse() * missing,
                                            options_.tick_s * max_force_n(mass_kg));
    if (!impulse.allFinite()) return;
    body.activate(true);
    body.applyImpulse(to_bullet(impulse), to_bullet(arm));
    const auto kept = btScalar(std::exp(-options_.spin_damping_hz * options_.tick_s));
    body.setAngularVelocity(kept * body.getAngularVelocity());
}

void Grabs::begin_tick(const std::function<Held(std::uint32_t object)>& find,
                       const Eigen::Vector3d& gravity) {
    for (Grab& grab : grabs_) {
        const Held held = --grab.ticks_left >= 0 ? find(grab.object) : Held{};
        if (held.soft != nullptr && !grab.handle.nodes.empty())
            pull(grab, *held.soft, gravity.norm());
        else if (held.body != nullptr && held.body->getInvMass() > btScalar(0))
            pull(grab, *held.body);
        else
            grab.ticks_left = -1;
    }
    std::erase_if(grabs_, [](const Grab& grab) { return grab.ticks_left < 0; });
}

}  // namespace atrium::physics
