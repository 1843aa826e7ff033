#pragma once

#include <LinearMath/btVector3.h>

#include <cstddef>
#include <vector>

class btDispatcher;
class btRigidBody;

namespace atrium::physics {

/// Which moving bodies stand: on fixed ones, or on others that stand. As of the contacts that a
/// dispatcher knows.
class Supports {
public:
    void find(btDispatcher& dispatcher, const btVector3& gravity);
    void clear();

    /// `body` touches a fixed one, from any side.
    bool touches_fixed(const btRigidBody& body) const;
    /// A push against `normal` presses `body` onto what carries it. It may tip it over.
    bool stands(const btRigidBody& body, const btVector3& normal) const;
    /// A push at `point`, against `normal`, presses `body` onto what carries it and cannot tip it
    /// over. Never without gravity.
    bool carries(const btRigidBody& body, const btVector3& point, const btVector3& normal) const;

private:
    struct Place {
        btScalar x, y;  // [m] perpendicular to gravity
    };
    struct Standing {
        const btRigidBody* body = nullptr;
        bool touches_fixed = false;
        bool is_carried = false;
        // where it is carried: a part of `areas_`, convex and counterclockwise
        std::size_t first = 0;
        std::size_t num = 0;
    };
    // One contact point between two bodies of which the upper one moves.
    struct Touch {
        const btRigidBody* upper;
        const btRigidBody* lower;
        Place place;
    };
    Standing& entry_of(const btRigidBody& body);
    const Standing* find_entry(const btRigidBody& body) const;
    Place place_of(const btVector3& point) const;
    void read_contacts(btDispatcher& dispatcher);
    void carry_upwards();
    void find_areas();
    void add_convex();

    btVector3 up_;  // unit length; zero: no gravity
    btVector3 along_[2];
    std::vector<Standing> standing_;  // in ascending order of address
    std::vector<Place> areas_;
    std::vector<Touch> touches_;  // scratch
    std::vector<Place> places_;   // scratch
};

}  // namespace atrium::physics
