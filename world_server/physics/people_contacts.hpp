#pragma once

#include "world_server/physics/people_field.hpp"
#include "world_server/physics/person_contact.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

class btDispatcher;
class btPersistentManifold;
class btRigidBody;

namespace atrium::physics {

struct PeopleContactOptions {
    /// Combined friction: the geometric mean of this and the object's.
    double friction = 2.0;
    /// Combined restitution: this, or half of the object's where that is more: skin damps.
    double restitution = 0.2;
    double escape_mps = 1.5;  // at which an object inside a person is led out
};

/// Where an object touched a person in a tick.
struct PersonTouch {
    std::string person;
    std::uint32_t object = 0;
    Eigen::Vector3f point;  // on the person, world [m]
};
inline constexpr std::size_t kMaxPersonTouches = 512;  // of a tick that are kept

/// Gives Bullet's solver the contacts of objects with people, who are in no Bullet world: before
/// each tick a manifold for each contact, between the object and a carrier, a kinematic body with
/// the velocity of the person's surface at that place.
///
/// What overlaps is moved apart by velocity, at a bounded speed, and not by shifting it: only so
/// does an object clasped between two surfaces feel force from both, and hence friction.
class PeopleContacts {
public:
    PeopleContacts(btDispatcher& dispatcher, const PeopleContactOptions& options);
    ~PeopleContacts();
    PeopleContacts(const PeopleContacts&) = delete;
    PeopleContacts& operator=(const PeopleContacts&) = delete;

    /// An object that moves; `body` must stay until `remove`.
    void add(std::uint32_t id, btRigidBody& body);
    void remove(std::uint32_t id);  // no harm if it is not there
    /// It has been put back to where it is and did not come there: a person of whom a part is
    /// inside it does not touch it before they are apart. Else it would stick on a hand.
    void put(std::uint32_t id);

    /// To be called by the pre-tick callback, after the field's own `begin_tick`.
    void begin_tick(const PeopleField& people, double tick_s);
    /// After the tick: takes the manifolds back.
    void end_tick();
    /// A person is gone for good: nothing is led out of her any more.
    void forget_person(const std::string& name);

    bool is_touched() const { return is_touched_; }  // a contact in this tick
    /// Of the last tick: those who were in touch, not all that was near.
    std::span<const PersonTouch> touches() const { return {touches_.data(), num_touches_}; }
    std::uint64_t num_escapes() const { return num_escapes_; }  // since the construction

private:
    struct Carrier;
    struct Tracked;
    struct Surface;
    void note_touch(const std::string& person, const Tracked& tracked, const PersonContact& at);
    void begin_body(Tracked& tracked, const PeopleField& people, double tick_s);
    bool lead_out(Tracked& tracked, const PeopleField& people);
    bool is_inside(const Tracked& tracked, const PersonField& person) const;
    bool is_around(const Tracked& tracked, const PersonField& person) const;
    // True where they are in touch.
    bool insert(Tracked& tracked,
                const PersonContact& contact,
                const Surface& surface,
                double tick_s);

    btDispatcher& dispatcher_;
    PeopleContactOptions options_;
    ContactFinder finder_;
    std::map<std::uint32_t, std::unique_ptr<Tracked>> bodies_;
    std::vector<std::unique_ptr<Carrier>> carriers_;  // the first num_used_ are of this tick
    std::size_t num_used_ = 0;
    std::vector<PersonTouch> touches_;  // the first num_touches_ are of this tick
    std::size_t num_touches_ = 0;
    std::uint64_t tick_ = 0;
    std::uint64_t num_escapes_ = 0;
    bool is_touched_ = false;
};

}  // namespace atrium::physics
