#pragma once

#include "world_server/physics/options/people_options.hpp"
#include "world_server/physics/people/people_field.hpp"
#include "world_server/physics/people/person_contact.hpp"

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

/// Contact of an object and a person in a tick.
struct PersonTouch {
    std::string person;
    std::uint32_t object = 0;
    Eigen::Vector3f point;  // on the person's surface, world frame [m]
};
inline constexpr std::size_t kMaxPersonTouches = 512;  // per tick; further touches are dropped

/// Adds contacts between objects and people to Bullet's solver.
///
/// People are in no Bullet world. Before each tick, every contact becomes a manifold between the
/// object and a carrier: a kinematic body with the velocity of the person's surface at the contact.
///
/// Overlaps are resolved by a bounded velocity, not by a shift of position. This way an object
/// clasped between two surfaces feels force from both, and hence friction.
class PeopleContacts {
public:
    PeopleContacts(btDispatcher& dispatcher, const PeopleContactOptions& options);
    ~PeopleContacts();
    PeopleContacts(const PeopleContacts&) = delete;
    PeopleContacts& operator=(const PeopleContacts&) = delete;

    /// Adds a dynamic object. `body` must exist until `remove`.
    void add(std::uint32_t id, btRigidBody& body);
    void remove(std::uint32_t id);  // no effect if the id is unknown
    /// Marks an object as teleported. A person who is inside it at that moment does not touch it
    /// until they have separated. Otherwise the object would stick to a hand.
    void mark_teleported(std::uint32_t id);

    /// Call in the pre-tick callback, after `PeopleField::begin_tick`.
    void begin_tick(const PeopleField& people, double tick_s);
    /// Call after the tick. Releases the manifolds.
    void end_tick();
    /// Forgets a person who has left: stops moving objects out of them.
    void forget_person(const std::string& name);

    bool is_touched() const { return is_touched_; }  // any contact in this tick
    /// Touches of the last tick. Contacts that were only near are not included.
    std::span<const PersonTouch> touches() const { return {touches_.data(), num_touches_}; }
    std::uint64_t num_escapes() const { return num_escapes_; }  // since construction

private:
    struct Carrier;
    struct Tracked;
    struct Surface;
    void note_touch(const std::string& person, const Tracked& tracked, const PersonContact& at);
    void begin_body(Tracked& tracked, const PeopleField& people, double tick_s);
    bool move_out(Tracked& tracked, const PeopleField& people);
    bool is_inside(const Tracked& tracked, const PersonField& person) const;
    bool is_around(const Tracked& tracked, const PersonField& person) const;
    // Returns true if object and person touch.
    bool insert(Tracked& tracked,
                const PersonContact& contact,
                const Surface& surface,
                double tick_s);

    btDispatcher& dispatcher_;
    PeopleContactOptions options_;
    ContactFinder finder_;
    std::map<std::uint32_t, std::unique_ptr<Tracked>> bodies_;
    std::vector<std::unique_ptr<Carrier>> carriers_;  // the first num_used_ belong to this tick
    std::size_t num_used_ = 0;
    std::vector<PersonTouch> touches_;  // the first num_touches_ belong to this tick
    std::size_t num_touches_ = 0;
    std::uint64_t tick_ = 0;
    std::uint64_t num_escapes_ = 0;
    bool is_touched_ = false;
};

}  // namespace atrium::physics
