#include "world_server/physics/world.hpp"

#include "world_server/physics/rigid/bullet_types.hpp"
#include "world_server/physics/world_impl.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

namespace atrium::physics {

World::Impl::Impl(const WorldOptions& world_options)
    : options(world_options),
      contacts(dispatcher, world_options.people.contacts),
      grabs({.tick_s = world_options.tick_s}),
      holds({.tick_s = world_options.tick_s}) {
    assert(options.tick_s > 0.0 && options.max_speed_mps > 0.0);
    world.setGravity(to_bullet(options.gravity));
    // without this, an object put or pressed onto a plane stands on one corner for the first ticks
    configuration.setPlaneConvexMultipointIterations(4, 4);
    world.getSolverInfo().m_splitImpulsePenetrationThreshold = -options.plain_contact_m;
    world.getSolverInfo().m_numIterations = options.solver_iterations;
    // solve friction next to each contact's normal force. (Two friction directions hold the object
    // as well, but then a cylinder that lands on its flat end tips over.)
    world.getSolverInfo().m_solverMode |= SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS;
    world.getDispatchInfo().m_deterministicOverlappingPairs = true;
    // by default Bullet lets motion of up to 4 cm per tick through, with which nuts and balls fell
    // through the floor of a mesh
    world.getDispatchInfo().m_allowedCcdPenetration = btScalar(0.001);
    world.setInternalTickCallback(&Impl::begin_tick, this, /*isPreTick=*/true);
    if (options.leaving == LeavePolicy::kBounce)
        surroundings.add_walls(box_of(options), options.wall_friction, options.wall_restitution);
}

World::Impl::~Impl() {
    soft.clear(world);
    for (auto& [id, object] : objects) {
        joints.remove_of(id);
        world.removeRigidBody(&object->body());
    }
}

void World::Impl::begin_tick(btDynamicsWorld* world, btScalar tick_s) {
    Impl& self = *static_cast<Impl*>(world->getWorldUserInfo());
    self.joints.begin_tick();
    const auto find_held = [&](std::uint32_t id) -> Grabs::Held {
        ObjectBody* object = self.find_moving(id);
        return {object == nullptr ? nullptr : &object->body(), self.soft.find(id)};
    };
    self.grabs.begin_tick(find_held, self.options.gravity);
    self.begin_holds();
    self.people.begin_tick(tick_s);
    self.contacts.begin_tick(self.people, tick_s);
    SoftSurroundings& around = self.soft.begin_tick(self.people);
    for (auto& [id, object] : self.objects) around.bodies.push_back(&object->body());
    const std::vector<btRigidBody*>& still = self.surroundings.bodies();
    around.bodies.insert(around.bodies.end(), still.begin(), still.end());
    if (!self.soft.bodies().empty()) around.supports.find(self.dispatcher, self.world.getGravity());
}

ObjectBody* World::Impl::find_moving(std::uint32_t id) {
    ObjectBody* object = find(id);
    return object == nullptr || !object->moves() ? nullptr : object;
}

World::World(const WorldOptions& options) : impl_(std::make_unique<Impl>(options)) {}
World::~World() = default;

AddResult World::add(const RigidObject& object) {
    if (find_problem(object)) return AddResult::kInvalid;
    if (impl_->objects.contains(object.id) || impl_->soft.contains(object.id)) {
        return AddResult::kIdInUse;
    }
    if (impl_->objects.size() >= impl_->options.max_objects) return AddResult::kWorldFull;
    auto body = std::make_unique<ObjectBody>(object, impl_->options);
    const int group = body->moves() ? kObjectGroup : kStaticGroup;
    const int mask = body->moves() ? kStaticGroup | kObjectGroup : kObjectGroup;
    impl_->world.addRigidBody(&body->body(), group, mask);
    if (body->moves()) impl_->contacts.add(object.id, body->body());
    impl_->objects.emplace(object.id, std::move(body));
    return AddResult::kAdded;
}

AddResult World::add_soft(const SoftObject& object) {
    if (impl_->objects.contains(object.id)) return AddResult::kIdInUse;
    return impl_->soft.add(object, impl_->world, [&](std::uint32_t id) -> btRigidBody* {
        const auto found = impl_->objects.find(id);
        return found == impl_->objects.end() ? nullptr : &found->second->body();
    });
}

bool World::remove(std::uint32_t id) { return impl_->remove(id); }

bool World::Impl::remove(std::uint32_t id) {
    const auto found_at = objects.find(id);
    if (found_at != objects.end()) {
        btRigidBody& body = found_at->second->body();
        wake_near(body);  // some may have rested on it
        soft.detach(body);
        joints.remove_of(id);
        contacts.remove(id);
        world.removeRigidBody(&body);
        objects.erase(found_at);
        centres_before.erase(id);
    } else if (soft.remove(id, world)) {
        wake_all();
    } else {
        return false;
    }
    grabs.forget(id);
    holds.forget(id);
    return true;
}

bool World::add_joint(const Joint& joint) {
    if (find_problem(joint)) return false;
    const auto a = impl_->objects.find(joint.a);
    const auto b = impl_->objects.find(joint.b);
    if (a == impl_->objects.end() || (joint.b != 0 && b == impl_->objects.end())) return false;
    ObjectBody* other = joint.b == 0 ? nullptr : b->second.get();
    if (!a->second->moves() && (other == nullptr || !other->moves())) return false;
    impl_->joints.add(joint, *a->second, other);
    return true;
}

bool World::add_static(const StaticMesh& mesh) { return impl_->surroundings.add(mesh); }

void World::reset() {
    btOverlappingPairCache& pairs = *impl_->broadphase.getOverlappingPairCache();
    for (auto& [id, object] : impl_->objects) {
        pairs.cleanProxyFromPairs(object->body().getBroadphaseHandle(), &impl_->dispatcher);
        object->reset_to_start();
        impl_->contacts.mark_teleported(id);
    }
    impl_->soft.reset();
}

bool World::set_state(const RigidState& state) {
    const auto found = impl_->objects.find(state.id);
    if (found == impl_->objects.end() || !found->second->moves()) return false;
    const geometry::RigidTransform& pose = state.world_from_object;
    if (!pose.translation.allFinite() || !(std::abs(pose.rotation.norm() - 1.0) <= 1e-3) ||
        !state.linear_velocity.allFinite() || !state.angular_velocity.allFinite()) {
        return false;
    }
    found->second->set_state(state);
    return true;
}

bool World::push(std::uint32_t id, const Eigen::Vector3d& impulse_ns) {
    const auto found = impl_->objects.find(id);
    if (found == impl_->objects.end()) return impl_->soft.push(id, impulse_ns);
    if (!found->second->moves() || !impulse_ns.allFinite()) return false;
    found->second->body().activate(true);
    found->second->body().applyCentralImpulse(to_bullet(impulse_ns));
    return true;
}

bool World::grab(const std::string& holder,
                 std::uint32_t id,
                 const Eigen::Vector3d& point_object,
                 const Eigen::Vector3d& goal_world) {
    if (!point_object.allFinite() || !goal_world.allFinite()) return false;
    if (const ObjectBody* object = impl_->find_moving(id)) {
        return impl_->grabs.hold(
            holder, id, object->object_from_body().inverse() * point_object, goal_world);
    }
    SoftBody* soft = impl_->soft.find(id);
    if (soft == nullptr) return false;
    const SoftHandle handle =
        handle_at(soft->body(), to_bullet(point_object), impl_->options.soft.handle.hand_m);
    return !handle.nodes.empty() && impl_->grabs.hold(holder, id, handle, goal_world);
}

bool World::move_grab(const std::string& holder,
                      std::uint32_t id,
                      const Eigen::Vector3d& goal_world) {
    return goal_world.allFinite() && impl_->grabs.move(holder, id, goal_world);
}

bool World::release(const std::string& holder, std::uint32_t id) {
    return impl_->grabs.release(holder, id);
}

void World::release_all(const std::string& holder) {
    impl_->grabs.release_all(holder);
    impl_->holds.let_go_all(holder);
}

std::size_t World::num_grabs() const { return impl_->grabs.size(); }

void World::set_person(const std::string& name, const PersonShape& shape) {
    impl_->people.set_person(name, shape);
}

void World::remove_person(const std::string& name) {
    if (!impl_->people.remove_person(name)) return;
    impl_->contacts.forget_person(name);
    impl_->wake_all();  // objects that lay on the person fall
}

void World::tick() {
    for (auto& [id, object] : impl_->objects) {
        if (!object->moves()) continue;
        impl_->centres_before[id] = object->centre();
    }
    impl_->world.stepSimulation(static_cast<btScalar>(impl_->options.tick_s), /*maxSubSteps=*/0);
    impl_->end_holds();
    const auto record = [&](const Incident& incident) { impl_->record(incident); };
    for (const std::uint32_t id : impl_->soft.end_tick(impl_->counters, record)) impl_->remove(id);
    impl_->contacts.end_tick();
    impl_->handle_incidents();
    const bool is_soft_touched = impl_->soft.is_touched();
    if (impl_->contacts.is_touched() || is_soft_touched) ++impl_->counters.num_contact_ticks;
    if (is_soft_touched) ++impl_->counters.num_soft_contact_ticks;
    impl_->counters.num_escapes = impl_->contacts.num_escapes();
    ++impl_->counters.num_ticks;
}

const SoftTopology* World::soft_topology(std::uint32_t id) const {
    const SoftBody* soft = impl_->soft.find(id);
    return soft == nullptr ? nullptr : &soft->topology();
}

std::size_t World::num_soft_nodes(std::uint32_t id) const {
    const SoftBody* soft = impl_->soft.find(id);
    return soft == nullptr ? 0 : soft->num_nodes();
}

const WorldCounters& World::counters() const { return impl_->counters; }
std::size_t World::num_objects() const { return impl_->objects.size(); }
std::size_t World::num_joints() const { return impl_->joints.size(); }
std::size_t World::num_people() const { return impl_->people.people().size(); }

std::size_t World::num_surfels() const {
    std::size_t num_surfels = 0;
    for (const auto& [name, person] : impl_->people.people()) num_surfels += person.num_surfels();
    return num_surfels;
}

}  // namespace atrium::physics
