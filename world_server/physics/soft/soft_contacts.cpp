#include "world_server/physics/soft/soft_contacts.hpp"

#include "world_server/physics/people/people_field.hpp"
#include "world_server/physics/rigid/shape_distance.hpp"

#include <BulletSoftBody/btSoftBody.h>
#include <LinearMath/btAabbUtil2.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace atrium::physics {
namespace {

bool is_any_loose(const SoftSample& sample, std::span<const std::uint8_t> loose) {
    return (loose[sample.nodes[0]] | loose[sample.nodes[1]] | loose[sample.nodes[2]]) != 0;
}

btScalar inverse_mass_of(const btRigidBody& body,
                         const btVector3& arm,
                         const btVector3& direction) {
    const btVector3 turn = arm.cross(direction);
    return body.getInvMass() + turn.dot(body.getInvInertiaTensorWorld() * turn);
}

// Velocity of the surface, including impulses on the body since the contact was found.
btVector3 velocity_of(const SoftContact& c) {
    return c.body != nullptr ? c.body->getVelocityInLocalPoint(c.arm) : c.velocity;
}

bool rests(const SoftContact& contact, const btVector3& velocity, btScalar still_mps) {
    const btScalar plane_mps = contact.normal.dot(contact.velocity);
    const btScalar closing_mps = plane_mps - contact.normal.dot(velocity);
    return std::abs(plane_mps) < still_mps && closing_mps < still_mps;
}

// The contact of a sample at `at`, whose path begins at `start`, both relative to the body's pose
// at the end of the tick.
SoftContact contact_at(const btRigidBody& body,
                       const ShapePoint& found,
                       const btVector3& at,
                       const btVector3& start,
                       const btVector3& velocity,
                       btScalar thickness_m) {
    SoftContact contact;
    contact.normal = body.getWorldTransform().getBasis() * found.normal;
    contact.point = at - contact.normal * (found.distance - thickness_m);
    contact.velocity = velocity;
    contact.depth = std::max(btScalar(0), -contact.normal.dot(start - contact.point));
    return contact;
}

// Finds the first point on the sample's path, relative to the body, that is within `thickness_m` of
// it. If there is none, uses the end of the path. If that is too far away, uses its beginning if it
// is near: what is behind the sample may push it back within the tick. Not if the push would press
// the body onto what carries it, which does not need that.
std::optional<SoftContact> find_contact_on_path(const btRigidBody& body,
                                                const Supports& supports,
                                                const SampleMotion& sample,
                                                const SoftContactSetup& setup) {
    const btScalar thickness_m = setup.thickness_m;
    const btTransform& pose = body.getWorldTransform();
    const btVector3 arm = sample.position - pose.getOrigin();
    const btVector3 velocity = body.getVelocityInLocalPoint(arm);
    const btVector3 way = (sample.velocity - velocity) * setup.tick_s;
    // relative to the body's pose, which is that at the end of the tick
    const btVector3 start = sample.position + velocity * setup.tick_s;
    const btScalar length = way.length();
    const btScalar reach = thickness_m + setup.options.margin_m;
    const btScalar near_m = thickness_m + setup.options.near_m;
    std::optional<ShapePoint> first, found;
    btVector3 at;
    const btScalar step_m = setup.options.step_m;
    btScalar walked = 0;
    for (int step = 0; step < setup.options.max_steps; ++step) {
        at = start + (length > 0 ? way * (walked / length) : btVector3(0, 0, 0));
        found = distance_to_shape(*body.getCollisionShape(),
                                  pose.invXform(at),
                                  std::max(reach + length - walked, near_m));
        if (step == 0) first = found;
        if (!found || found->distance <= thickness_m || walked >= length) break;
        walked = std::min(length, walked + std::max(found->distance - thickness_m, step_m));
    }
    if (found && found->distance <= reach)
        return contact_at(body, *found, at, start, velocity, thickness_m);
    if (!first || first->distance > near_m) return std::nullopt;
    const SoftContact near = contact_at(body, *first, start, start, velocity, thickness_m);
    if (supports.stands(body, near.normal)) return std::nullopt;
    return near;
}

std::optional<SoftContact> find_person_contact(const PeopleField& people,
                                               const SampleMotion& sample,
                                               const SoftContactSetup& setup) {
    const btVector3& x = sample.position;
    const btVector3& v = sample.velocity;
    const auto found = people.query({x.x(), x.y(), x.z()}, {.velocity = {v.x(), v.y(), v.z()}});
    if (!found) return std::nullopt;
    SoftContact contact;
    contact.normal = btVector3(found->normal.x(), found->normal.y(), found->normal.z());
    contact.velocity = btVector3(found->velocity.x(), found->velocity.y(), found->velocity.z());
    const btScalar gap = found->distance_m - setup.thickness_m;
    const btScalar closing = contact.normal.dot(contact.velocity - v) * setup.tick_s;
    if (gap - std::max(closing, btScalar(0)) > setup.options.margin_m) return std::nullopt;
    contact.point = x - contact.normal * gap + contact.velocity * setup.tick_s;
    contact.depth = std::max(btScalar(0), -gap);
    contact.friction = std::sqrt(setup.friction * setup.person_friction);
    return contact;
}

}  // namespace

void SoftContacts::find(btSoftBody& soft,
                        const SoftSkin& skin,
                        const PeopleField* people,
                        const std::vector<btRigidBody*>& bodies,
                        const Supports& supports,
                        const SoftContactSetup& setup) {
    contacts_.clear();
    num_person_contacts_ = 0;
    ways_.clear();
    for (const SoftSample& sample : skin.samples) ways_.push_back(motion_of(soft, sample));
    if (people != nullptr && !people->people().empty()) {
        for (std::size_t i = 0; i < skin.samples.size(); ++i) {
            const SoftSample& sample = skin.samples[i];
            if (!(ways_[i].inverse_mass > 0) || is_any_loose(sample, skin.loose)) continue;
            const auto contact = find_person_contact(*people, ways_[i], setup);
            if (!contact) continue;
            const auto out = outward_at(skin, i);
            if (out && contact->normal.dot(*out) > setup.options.from_inside) continue;
            contacts_.push_back(*contact);
            contacts_.back().sample = sample;
            ++num_person_contacts_;
        }
    }
    is_calm_ = skin.is_calm && num_person_contacts_ == 0;
    for (btRigidBody* body : bodies) {
        if (!is_scenery(*body)) find_with(soft, *body, skin, supports, setup);
    }
    find_with_scenery(soft, bodies, skin, setup);
}

// Contacts with one rigid body. Most bodies are out of reach as a whole.
void SoftContacts::find_with(const btSoftBody& soft,
                             btRigidBody& body,
                             const SoftSkin& skin,
                             const Supports& supports,
                             const SoftContactSetup& setup) {
    btVector3 low, high;
    body.getAabb(low, high);
    const btScalar reach = setup.thickness_m + setup.options.margin_m;
    const btVector3 travel =
        body.getLinearVelocity().absolute() * setup.tick_s + btVector3(reach, reach, reach);
    low -= travel;
    high += travel;
    if (!TestAabbAgainstAabb2(low, high, soft.m_bounds[0], soft.m_bounds[1])) return;
    for (std::size_t i = 0; i < skin.samples.size(); ++i) {
        if (!(ways_[i].inverse_mass > 0)) continue;
        const btVector3& start = ways_[i].position;
        const btVector3 end = start + ways_[i].velocity * setup.tick_s;
        btVector3 way_low = start, way_high = start;
        way_low.setMin(end);
        way_high.setMax(end);
        if (!TestAabbAgainstAabb2(low, high, way_low, way_high)) continue;
        auto contact = find_contact_on_path(body, supports, ways_[i], setup);
        if (!contact) continue;
        contact->sample = skin.samples[i];
        contact->sample_kg = 1 / ways_[i].inverse_mass;
        contact->friction = std::sqrt(setup.friction * body.getFriction());
        const bool is_asleep = body.getInvMass() > 0 && !body.isActive();
        if (is_asleep && !is_calm_) body.activate();
        if (is_asleep && is_calm_) {
            contact->sleeper = &body;
        } else if (body.getInvMass() > 0) {
            contact->body = &body;
            contact->arm = contact->point - body.getCenterOfMassPosition();
            contact->body_inverse_mass = inverse_mass_of(body, contact->arm, contact->normal);
            contact->is_carried = supports.carries(body, contact->point, contact->normal) ||
                                  (supports.stands(body, contact->normal) &&
                                   rests(*contact, ways_[i].velocity, setup.options.still_mps));
        }
        contacts_.push_back(*contact);
    }
}

void SoftContacts::find_with_scenery(const btSoftBody& soft,
                                     const std::vector<btRigidBody*>& bodies,
                                     const SoftSkin& skin,
                                     const SoftContactSetup& setup) {
    const ContactLimits limits{setup.tick_s,
                               setup.thickness_m,
                               setup.options.margin_m,
                               setup.options.lost_m,
                               setup.options.from_inside};
    const Box bounds{soft.m_bounds[0], soft.m_bounds[1]};
    const auto found =
        scenery_.find(skin, ways_, bodies, bounds, limits, setup.options.same_normal);
    for (const SceneryContact& with : found) {
        SoftContact contact;
        contact.sample = skin.samples[with.sample];
        contact.normal = with.normal;
        const btScalar gap = with.distance - setup.thickness_m;
        contact.point = ways_[with.sample].position - with.normal * gap;
        contact.velocity.setZero();
        contact.depth = std::max(btScalar(0), -gap);
        contact.friction = std::sqrt(setup.friction * with.friction);
        contacts_.push_back(contact);
    }
}

void SoftContacts::begin_substep() {
    for (SoftContact& c : contacts_) {
        c.normal_correction = 0;
        c.friction_correction.setZero();
    }
}

void SoftContacts::solve(btSoftBody& soft,
                         btScalar substep_s,
                         btScalar left_s,
                         const SoftContactSetup& setup) {
    const btScalar done_s = setup.tick_s - left_s;
    for (SoftContact& c : contacts_) {
        btVector3 x(0, 0, 0), q(0, 0, 0);
        btScalar own_inverse_mass = 0;
        for (int i = 0; i < 3; ++i) {
            const btSoftBody::Node& node = soft.m_nodes[static_cast<int>(c.sample.nodes[i])];
            const btScalar w = c.sample.weights[i];
            x += w * node.m_x;
            q += w * node.m_q;
            own_inverse_mass += w * w * node.m_im;
        }
        const btScalar allowed =
            -std::max(btScalar(0), c.depth - setup.options.recovery_mps * done_s);
        const btVector3 velocity = velocity_of(c);
        const btScalar height = c.normal.dot(x - c.point + c.velocity * left_s) - c.shift -
                                c.normal.dot(velocity - c.velocity) * substep_s;
        btVector3 impulse(0, 0, 0);
        if (height < allowed) {
            const btScalar yielding = c.is_carried ? btScalar(0) : c.body_inverse_mass;
            const btScalar push = (allowed - height) / (own_inverse_mass + yielding);
            c.normal_correction += push;
            impulse = c.normal * push;
            if (c.is_carried) c.load += push / substep_s;
        }
        if (c.normal_correction <= 0) continue;
        btVector3 reaction = c.is_carried ? btVector3(0, 0, 0) : impulse;
        btVector3 slip = x + impulse * own_inverse_mass - q - velocity * substep_s;
        slip -= c.normal * c.normal.dot(slip);
        // bounds the friction of a substep by its total pressure
        const btVector3 wanted =
            c.friction_correction - slip / (own_inverse_mass + c.body_inverse_mass);
        const btScalar most = c.friction * c.normal_correction;
        const btScalar size = wanted.length();
        const btVector3 held = size > most ? wanted * (most / size) : wanted;
        impulse += held - c.friction_correction;
        reaction += held - c.friction_correction;
        c.friction_correction = held;
        move(soft, c.sample, impulse);
        if (c.body != nullptr) c.body->applyImpulse(-reaction / substep_s, c.arm);
    }
}

void SoftContacts::end_substep(btSoftBody& soft,
                               btScalar substep_s,
                               const SoftContactSetup& setup) {
    for (SoftContact& c : contacts_) {
        const btVector3 velocity = velocity_of(c);
        c.shift += c.normal.dot(velocity - c.velocity) * substep_s;
        if (c.normal_correction <= 0) continue;
        const btScalar still_mps = setup.options.still_mps;
        const bool moves = !is_calm_ || c.velocity.length2() > still_mps * still_mps;
        if (c.body != nullptr && moves) c.body->activate();
        if (c.depth <= 0) continue;
        for (int i = 0; i < 3; ++i) {
            if (c.sample.weights[i] <= 0) continue;
            btSoftBody::Node& node = soft.m_nodes[static_cast<int>(c.sample.nodes[i])];
            const btScalar out = c.normal.dot(node.m_v - velocity);
            if (out > 0) node.m_v -= c.normal * std::min(out, setup.options.recovery_mps);
        }
    }
}

btScalar SoftContacts::heaviest_kg() const {
    btScalar heaviest = 0;
    for (const SoftContact& c : contacts_)
        if (c.body != nullptr && !c.is_carried)
            heaviest = std::max(heaviest, 1 / c.body->getInvMass());
    return heaviest;
}

// Of bodies that stand on it: what touches them is below their middle, and they press it down.
// Contacts with one body follow one another.
btScalar SoftContacts::heaviest_load() const {
    constexpr btScalar kDown = -0.7F;  // z of the normal
    btScalar heaviest = 0;
    for (std::size_t i = 0; i < contacts_.size();) {
        const btRigidBody* body = contacts_[i].body;
        btScalar touched_kg = 0;
        for (; i < contacts_.size() && contacts_[i].body == body; ++i) {
            const SoftContact& c = contacts_[i];
            if (c.normal.z() < kDown && c.arm.z() < 0 && !c.is_carried) touched_kg += c.sample_kg;
        }
        if (body != nullptr && touched_kg > 0)
            heaviest = std::max(heaviest, 1 / (body->getInvMass() * touched_kg));
    }
    return heaviest;
}

btScalar SoftContacts::rebound_mps() const {
    btScalar heaviest = 0, speed = 0;
    for (const SoftContact& c : contacts_) {
        if (c.body == nullptr || c.is_carried) continue;
        const btScalar mass = 1 / c.body->getInvMass();
        const btScalar away = -c.normal.dot(c.body->getLinearVelocity());
        if (mass < heaviest || (mass == heaviest && away <= speed)) continue;
        heaviest = mass;
        speed = away;
    }
    return speed;
}

void SoftContacts::load_carriers() {
    for (const SoftContact& c : contacts_)
        if (c.is_carried) c.body->applyImpulse(-c.normal * c.load, c.arm);
}

void SoftContacts::wake_bodies() {
    for (const SoftContact& c : contacts_)
        if (c.sleeper != nullptr) c.sleeper->activate();
}

}  // namespace atrium::physics
