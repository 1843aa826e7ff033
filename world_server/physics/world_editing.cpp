// Holds, places and changes objects of a running world.
#include "world_server/physics/rigid/bullet_types.hpp"
#include "world_server/physics/world_impl.hpp"

#include <algorithm>

namespace atrium::physics {

void World::Impl::wake_all() {
    for (auto& [id, object] : objects) {
        if (object->moves()) object->body().activate();
    }
}

void World::Impl::wake_near(const btRigidBody& body) {
    constexpr btScalar kMarginM = 0.02;
    btVector3 low;
    btVector3 high;
    body.getAabb(low, high);
    const btVector3 margin(kMarginM, kMarginM, kMarginM);
    low -= margin;
    high += margin;
    for (auto& [id, object] : objects) {
        if (!object->moves()) continue;
        btVector3 its_low;
        btVector3 its_high;
        object->body().getAabb(its_low, its_high);
        if (TestAabbAgainstAabb2(low, high, its_low, its_high)) object->body().activate();
    }
}

void World::Impl::begin_holds() {
    if (holds.begin_tick([this](std::uint32_t id) { return find(id); })) wake_all();
}

void World::Impl::end_holds() {
    if (holds.size() > 0) holds.end_tick([this](std::uint32_t id) { return find(id); });
}

ObjectBody* World::Impl::find(std::uint32_t id) {
    const auto entry = objects.find(id);
    return entry == objects.end() ? nullptr : entry->second.get();
}

const RigidObject* World::object(std::uint32_t id) const {
    const ObjectBody* found = impl_->find(id);
    return found == nullptr ? nullptr : &found->object();
}

std::optional<geometry::RigidTransform> World::pose_of(std::uint32_t id) const {
    const ObjectBody* found = impl_->find(id);
    if (found == nullptr) return std::nullopt;
    return found->state().world_from_object;
}

bool World::is_joined(std::uint32_t id) const {
    for (const auto& joint : impl_->joints.all()) {
        if (joint->joint().a == id || joint->joint().b == id) return true;
    }
    for (const auto& [soft_id, soft] : impl_->soft.bodies()) {
        const auto& pins = soft->object().pins;
        if (std::any_of(
                pins.begin(), pins.end(), [&](const SoftPin& pin) { return pin.object_id == id; }))
            return true;
    }
    return false;
}

HoldResult World::hold(const std::string& holder,
                       std::uint32_t id,
                       const geometry::RigidTransform& goal) {
    if (impl_->find(id) == nullptr) return HoldResult::kUnknownObject;
    return impl_->holds.hold(holder, id, goal);
}

bool World::let_go(const std::string& holder, std::uint32_t id) {
    return impl_->holds.let_go(holder, id);
}

std::string World::holder_of(std::uint32_t id) const { return impl_->holds.holder_of(id); }

bool World::place(std::uint32_t id, const geometry::RigidTransform& pose) {
    ObjectBody* found = impl_->find(id);
    if (found == nullptr) return false;
    // only what rested on it or will touch it: an edit must not disturb what is far away
    impl_->wake_near(found->body());
    found->set_state({.id = id, .world_from_object = pose});
    if (found->moves()) impl_->contacts.mark_teleported(id);
    impl_->wake_near(found->body());
    return true;
}

bool World::set_start(std::uint32_t id, const geometry::RigidTransform& pose) {
    ObjectBody* found = impl_->find(id);
    if (found == nullptr) return false;
    found->set_start(pose);
    return true;
}

bool World::change(const RigidObject& object) {
    ObjectBody* found = impl_->find(object.id);
    if (found == nullptr || find_problem(object)) return false;
    const RigidObject& now = found->object();
    const bool is_same_body =
        now.size_m == object.size_m && (now.mass_kg > 0.0) == (object.mass_kg > 0.0);
    if (is_same_body) {
        found->set_material(object.mass_kg, object.friction, object.restitution);
        if (found->moves()) found->body().activate(true);
        return true;
    }
    if (is_joined(object.id)) return false;
    RigidState state = found->state();
    const std::string holder = holder_of(object.id);
    impl_->remove(object.id);
    if (add(object) != AddResult::kAdded) return false;  // not possible: it was there
    if (object.mass_kg == 0.0)
        state = {.id = object.id, .world_from_object = state.world_from_object};
    impl_->find(object.id)->set_state(state);
    if (!holder.empty())
        static_cast<void>(impl_->holds.hold(holder, object.id, state.world_from_object));
    if (object.mass_kg > 0.0) impl_->contacts.mark_teleported(object.id);
    return true;
}

}  // namespace atrium::physics
