// Reads, restores and hashes the state of a world.
#include "core/base/fnv1a.hpp"
#include "world_server/physics/state_transfer.hpp"
#include "world_server/physics/world_impl.hpp"

#include <bit>

namespace atrium::physics {

void World::get_state(WorldState& state) const {
    state.tick = impl_->counters.num_ticks;
    state.objects.clear();
    for (const auto& [id, object] : impl_->objects) state.objects.push_back(motion_of(*object));
    get_soft_states(state.soft);
}

bool World::set_state(const WorldState& state) {
    for (const ObjectMotion& motion : state.objects) {
        if (!impl_->objects.contains(motion.id) || !is_valid(motion)) return false;
    }
    for (const SoftState& motion : state.soft) {
        const SoftBody* soft = impl_->soft.find(motion.id);
        if (soft == nullptr || !is_valid(motion)) return false;
        if (soft->num_nodes() != motion.positions.size()) return false;
    }
    for (const ObjectMotion& motion : state.objects) {
        set_motion(motion, *impl_->objects.at(motion.id));
    }
    for (const SoftState& motion : state.soft) restore_soft(motion);
    // after all motion is set: it decides the order in the broad phase
    std::vector<btRigidBody*> bodies;
    for (auto& [id, object] : impl_->objects) bodies.push_back(&object->body());
    forget_history(impl_->world, bodies);
    impl_->counters.num_ticks = state.tick;
    return true;
}

void World::get_states(std::vector<RigidState>& states) const {
    states.clear();
    for (const auto& [id, object] : impl_->objects) states.push_back(object->state());
}

void World::get_soft_states(std::vector<SoftState>& states) const {
    states.resize(impl_->soft.bodies().size());
    std::size_t i = 0;
    for (const auto& [id, soft] : impl_->soft.bodies()) soft->save(states[i++]);
}

bool World::get_soft_nodes(std::uint32_t id, std::vector<Eigen::Vector3f>& nodes) const {
    const SoftBody* soft = impl_->soft.find(id);
    if (soft == nullptr) return false;
    soft->get_positions(nodes);
    return true;
}

void World::get_people(std::vector<PersonSnapshot>& people) const {
    people.resize(impl_->people.people().size());
    std::size_t i = 0;
    for (const auto& [name, field] : impl_->people.people()) {
        PersonSnapshot& person = people[i++];
        person.name = name;
        person.surfels = field.shape();
        person.share_to_go = field.share_to_go();
        person.capture_time = field.capture_time();
        person.touches.clear();
        for (const PersonTouch& touch : impl_->contacts.touches()) {
            if (touch.person == name) person.touches.push_back({touch.object, touch.point});
        }
    }
}

bool World::restore_soft(const SoftState& state) {
    SoftBody* soft = impl_->soft.find(state.id);
    return soft != nullptr && soft->restore(state);
}

std::uint64_t World::state_hash() const {
    Fnv1a hash;
    const auto add = [&](double value) { hash.add(std::bit_cast<std::uint64_t>(value)); };
    for (const auto& [id, object] : impl_->objects) {
        const RigidState state = object->state();
        add(id);
        for (const double x : state.world_from_object.translation) add(x);
        for (const double x : state.world_from_object.rotation.coeffs()) add(x);
        for (const double x : state.linear_velocity) add(x);
        for (const double x : state.angular_velocity) add(x);
    }
    SoftState state;
    for (const auto& [id, soft] : impl_->soft.bodies()) {
        soft->save(state);
        add(id);
        for (const auto* vectors : {&state.positions, &state.velocities}) {
            for (const Eigen::Vector3f& v : *vectors) {
                for (const float x : v) add(x);
            }
        }
    }
    return hash.value();
}

}  // namespace atrium::physics
