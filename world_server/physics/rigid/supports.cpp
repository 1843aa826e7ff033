#include "world_server/physics/rigid/supports.hpp"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <functional>

namespace atrium::physics {
namespace {

constexpr btScalar kLeastUp = 0.7F;  // cosine: a steeper contact does not carry
constexpr int kMostLevels = 16;      // of bodies on bodies

btScalar turn_of(btScalar ax, btScalar ay, btScalar bx, btScalar by) { return ax * by - ay * bx; }

}  // namespace

void Supports::clear() {
    standing_.clear();
    areas_.clear();
}

void Supports::find(btDispatcher& dispatcher, const btVector3& gravity) {
    clear();
    const btScalar strength = gravity.length();
    up_ = strength > 0 ? btVector3(-gravity / strength) : btVector3(0, 0, 0);
    for (btVector3& axis : along_) axis.setZero();
    if (strength > 0) btPlaneSpace1(up_, along_[0], along_[1]);
    read_contacts(dispatcher);
    carry_upwards();
    find_areas();
}

void Supports::read_contacts(btDispatcher& dispatcher) {
    touches_.clear();
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
        const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
        const btRigidBody* a = btRigidBody::upcast(manifold.getBody0());
        const btRigidBody* b = btRigidBody::upcast(manifold.getBody1());
        if (a == nullptr || b == nullptr || manifold.getNumContacts() == 0) continue;
        if (a->getInvMass() > 0 && b->getInvMass() == 0) entry_of(*a).touches_fixed = true;
        if (b->getInvMass() > 0 && a->getInvMass() == 0) entry_of(*b).touches_fixed = true;
        for (int k = 0; k < manifold.getNumContacts(); ++k) {
            const btManifoldPoint& point = manifold.getContactPoint(k);
            const btScalar rise = point.m_normalWorldOnB.dot(up_);
            const Place place = place_of(point.getPositionWorldOnB());
            if (rise > kLeastUp && a->getInvMass() > 0) touches_.push_back({a, b, place});
            if (rise < -kLeastUp && b->getInvMass() > 0) touches_.push_back({b, a, place});
        }
    }
}

// Level by level: what touches a carrier from above is carried.
void Supports::carry_upwards() {
    bool is_changed = true;
    for (int level = 0; is_changed && level < kMostLevels; ++level) {
        is_changed = false;
        for (const Touch& touch : touches_) {
            const Standing* lower = find_entry(*touch.lower);
            if (touch.lower->getInvMass() > 0 && (lower == nullptr || !lower->is_carried)) continue;
            Standing& upper = entry_of(*touch.upper);
            is_changed |= !upper.is_carried;
            upper.is_carried = true;
        }
    }
    std::erase_if(touches_, [this](const Touch& touch) {
        const Standing* lower = find_entry(*touch.lower);
        return touch.lower->getInvMass() > 0 && (lower == nullptr || !lower->is_carried);
    });
}

void Supports::find_areas() {
    std::sort(touches_.begin(), touches_.end(), [](const Touch& a, const Touch& b) {
        return std::less<const btRigidBody*>()(a.upper, b.upper);
    });
    for (std::size_t i = 0; i < touches_.size();) {
        Standing& entry = entry_of(*touches_[i].upper);
        places_.clear();
        for (; i < touches_.size() && touches_[i].upper == entry.body; ++i)
            places_.push_back(touches_[i].place);
        entry.first = areas_.size();
        add_convex();
        entry.num = areas_.size() - entry.first;
    }
}

bool Supports::touches_fixed(const btRigidBody& body) const {
    const Standing* entry = find_entry(body);
    return entry != nullptr && entry->touches_fixed;
}

bool Supports::stands(const btRigidBody& body, const btVector3& normal) const {
    if (normal.dot(up_) < kLeastUp) return false;
    const Standing* entry = find_entry(body);
    return entry != nullptr && entry->is_carried;
}

bool Supports::carries(const btRigidBody& body,
                       const btVector3& point,
                       const btVector3& normal) const {
    if (normal.dot(up_) < kLeastUp) return false;
    const Standing* entry = find_entry(body);
    if (entry == nullptr || entry->num < 3) return false;
    const Place at = place_of(point);
    for (std::size_t i = 0; i < entry->num; ++i) {
        const Place& from = areas_[entry->first + i];
        const Place& to = areas_[entry->first + (i + 1) % entry->num];
        if (turn_of(to.x - from.x, to.y - from.y, at.x - from.x, at.y - from.y) < 0) return false;
    }
    return true;
}

Supports::Standing& Supports::entry_of(const btRigidBody& body) {
    const auto at = std::lower_bound(
        standing_.begin(), standing_.end(), &body, [](const Standing& entry, const auto* wanted) {
            return std::less<const btRigidBody*>()(entry.body, wanted);
        });
    if (at != standing_.end() && at->body == &body) return *at;
    return *standing_.insert(at, Standing{.body = &body});
}

const Supports::Standing* Supports::find_entry(const btRigidBody& body) const {
    const auto at = std::lower_bound(
        standing_.begin(), standing_.end(), &body, [](const Standing& entry, const auto* wanted) {
            return std::less<const btRigidBody*>()(entry.body, wanted);
        });
    return at != standing_.end() && at->body == &body ? &*at : nullptr;
}

Supports::Place Supports::place_of(const btVector3& point) const {
    return {along_[0].dot(point), along_[1].dot(point)};
}

// Adds the convex hull of `places_` to `areas_`: Andrew's monotone chain.
void Supports::add_convex() {
    const std::size_t first = areas_.size();
    std::sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) {
        return a.x != b.x ? a.x < b.x : a.y < b.y;
    });
    const auto add = [&](const Place& place, std::size_t least) {
        while (areas_.size() > least) {
            const Place& last = areas_.back();
            const Place& before = areas_[areas_.size() - 2];
            if (turn_of(last.x - before.x, last.y - before.y, place.x - last.x, place.y - last.y) >
                0)
                break;
            areas_.pop_back();
        }
        areas_.push_back(place);
    };
    for (const Place& place : places_) add(place, first + 1);
    const std::size_t num_lower = areas_.size();
    for (std::size_t i = places_.size() - 1; i-- > 0;) add(places_[i], num_lower);
    if (areas_.size() > first + 1) areas_.pop_back();  // the first one again
}

}  // namespace atrium::physics
