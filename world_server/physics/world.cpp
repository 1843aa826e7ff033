#include "world_server/physics/world.hpp"

#include "world_server/physics/bullet_types.hpp"
#include "world_server/physics/grab.hpp"
#include "world_server/physics/joints.hpp"
#include "world_server/physics/object_body.hpp"
#include "world_server/physics/people_contacts.hpp"
#include "world_server/physics/people_field.hpp"
#include "world_server/physics/soft_bodies.hpp"

#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <map>
#include <set>

namespace atrium::physics {
namespace {

/// Collision groups of the Bullet world, one bit each.
enum CollisionGroup : int { kStillGroup = 1, kObjectGroup = 2 };

// Overlap above which Bullet separates without adding velocity; its default of 4 cm makes whatever
// is pressed by a hand pop away.
constexpr float kPlainContactM = 0.002F;
constexpr int kSolverIterations = 20;
// Nothing gains more in a tick than a few times what it may have at all.
constexpr double kRunawayFactor = 4.0;
constexpr double kTornM = 0.25;
constexpr double kBehindWallM = 0.5;
constexpr std::size_t kMaxIncidents = 256;

}  // namespace

struct World::Impl {
    explicit Impl(const WorldOptions& world_options);
    ~Impl();
    static void begin_tick(btDynamicsWorld* world, btScalar tick_s);
    ObjectBody* find_moving(std::uint32_t id);
    std::optional<IncidentKind> guard(ObjectBody& object);
    void guard_all();
    void act_on(const Incident& incident);
    void record(const Incident& incident);
    bool remove(std::uint32_t id);

    WorldOptions options;
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    SoftBodies soft{options};
    btSoftRigidDynamicsWorld world{
        &dispatcher, &broadphase, &solver, &configuration, soft.solver()};
    std::map<std::uint32_t, std::unique_ptr<ObjectBody>> objects;
    PeopleField people;
    PeopleContacts contacts;
    Grabs grabs;
    std::map<std::uint32_t, Eigen::Vector3d> centres_before;  // of the objects that move
    Surroundings surroundings{world, kStillGroup, kObjectGroup};
    Joints joints{world, options.tick_s};
    std::vector<Incident> found;         // in this tick; scratch
    std::set<std::uint32_t> dealt_with;  // in this tick; scratch
    std::vector<Incident> incidents;
    WorldCounters counters;
};

World::Impl::Impl(const WorldOptions& world_options)
    : options(world_options),
      contacts(dispatcher,
               {.friction = world_options.person_friction,
                .restitution = world_options.person_restitution,
                .escape_mps = world_options.escape_mps}),
      grabs({.tick_s = world_options.tick_s}) {
    assert(options.tick_s > 0.0 && options.max_speed_mps > 0.0);
    world.setGravity(to_bullet(options.gravity));
    // else what is put down on a plane, or pressed onto it, stands on one corner for the first
    // ticks
    configuration.setPlaneConvexMultipointIterations(4, 4);
    world.getSolverInfo().m_splitImpulsePenetrationThreshold = -kPlainContactM;
    // what is clasped between two palms needs force from both
    world.getSolverInfo().m_numIterations = kSolverIterations;
    world.getSolverInfo().m_solverMode |= SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS;
    world.getDispatchInfo().m_deterministicOverlappingPairs = true;
    world.setInternalTickCallback(&Impl::begin_tick, this, /*isPreTick=*/true);
    if (options.leaving == LeavePolicy::kBounce) surroundings.add_walls(box_of(options));
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
    self.grabs.begin_tick([&](std::uint32_t id) -> btRigidBody* {
        ObjectBody* object = self.find_moving(id);
        return object == nullptr ? nullptr : &object->body();
    });
    self.people.begin_tick(tick_s);
    self.contacts.begin_tick(self.people, tick_s);
    std::vector<btRigidBody*>& around = self.soft.begin_tick(self.people);
    for (auto& [id, object] : self.objects) around.push_back(&object->body());
}

ObjectBody* World::Impl::find_moving(std::uint32_t id) {
    const auto object = objects.find(id);
    return object == objects.end() || !object->second->moves() ? nullptr : object->second.get();
}

// What is wrong with an object after a tick; limits its motion where nothing is.
std::optional<IncidentKind> World::Impl::guard(ObjectBody& object) {
    if (!object.is_finite()) return IncidentKind::kNotFinite;
    const double speed = from_bullet(object.body().getLinearVelocity()).norm();
    if (speed > kRunawayFactor * options.max_speed_mps) return IncidentKind::kRunaway;
    if (object.body().isActive()) {
        object.limit_motion(centres_before[object.object().id], options);
    }
    geometry::Aabb box = box_of(options);
    if (options.leaving == LeavePolicy::kBounce) {
        box.min.array() -= kBehindWallM;
        box.max.array() += kBehindWallM;
    }
    if (!box.contains(object.centre())) return IncidentKind::kLeft;
    return std::nullopt;
}

void World::Impl::guard_all() {
    found.clear();
    dealt_with.clear();
    for (auto& [id, object] : objects) {
        if (!object->moves()) continue;
        if (const auto kind = guard(*object)) found.push_back({id, *kind});
    }
    for (const auto& joint : joints.all()) {
        if (!(joint->gap_m() <= kTornM)) found.push_back({joint->joint().a, IncidentKind::kTorn});
    }
    for (const Incident& incident : found) {
        // what is joined is put back together, once
        if (!dealt_with.contains(incident.object)) act_on(incident);
    }
}

void World::Impl::act_on(const Incident& incident) {
    switch (incident.kind) {
        case IncidentKind::kNotFinite:
            ++counters.num_not_finite;
            break;
        case IncidentKind::kRunaway:
            ++counters.num_runaways;
            break;
        case IncidentKind::kTorn:
            ++counters.num_torn;
            break;
        case IncidentKind::kLeft:
        case IncidentKind::kRemoved:
            ++counters.num_strays;
            break;
    }
    const bool removes =
        incident.kind == IncidentKind::kLeft && options.leaving == LeavePolicy::kRemove;
    if (!removes) record(incident);
    for (const std::uint32_t id : joints.group_of(incident.object)) {
        dealt_with.insert(id);
        const auto member = objects.find(id);
        if (member == objects.end() || !member->second->moves()) continue;
        if (!removes) {
            member->second->put_back();
        } else if (remove(id)) {
            record({id, IncidentKind::kRemoved});
        }
    }
}

void World::Impl::record(const Incident& incident) {
    if (incidents.size() == kMaxIncidents) incidents.erase(incidents.begin());
    incidents.push_back(incident);
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
    const int group = body->moves() ? kObjectGroup : kStillGroup;
    const int mask = body->moves() ? kStillGroup | kObjectGroup : kObjectGroup;
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
        soft.untie(body);
        joints.remove_of(id);
        contacts.remove(id);
        world.removeRigidBody(&body);
        objects.erase(found_at);
        centres_before.erase(id);
        grabs.forget(id);
    } else if (!soft.remove(id, world)) {
        return false;
    }
    // what rested on it must not go on sleeping in the air
    for (auto& [other, object] : objects) {
        if (object->moves()) object->body().activate();
    }
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

bool World::add_still(const StillMesh& mesh) { return impl_->surroundings.add(mesh); }

void World::reset() {
    btOverlappingPairCache& pairs = *impl_->broadphase.getOverlappingPairCache();
    for (auto& [id, object] : impl_->objects) {
        pairs.cleanProxyFromPairs(object->body().getBroadphaseHandle(), &impl_->dispatcher);
        object->put_back();
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
    const ObjectBody* object = impl_->find_moving(id);
    return object != nullptr &&
           impl_->grabs.hold(
               holder, id, object->object_from_body().inverse() * point_object, goal_world);
}

bool World::move_grab(const std::string& holder,
                      std::uint32_t id,
                      const Eigen::Vector3d& goal_world) {
    return goal_world.allFinite() && impl_->grabs.move(holder, id, goal_world);
}

bool World::release(const std::string& holder, std::uint32_t id) {
    return impl_->grabs.release(holder, id);
}

void World::release_all(const std::string& holder) { impl_->grabs.release_all(holder); }

std::size_t World::num_grabs() const { return impl_->grabs.size(); }

void World::get_state(WorldState& state) const {
    state.tick = impl_->counters.num_ticks;
    state.objects.clear();
    for (const auto& [id, object] : impl_->objects) state.objects.push_back(motion_of(*object));
    std::vector<SoftState> soft;
    get_soft_states(soft);
    state.soft.clear();
    for (SoftState& s : soft) {
        state.soft.push_back(
            {s.id, std::move(s.positions), std::move(s.velocities), s.num_torn_ticks});
    }
}

bool World::set_state(const WorldState& state) {
    for (const ObjectMotion& motion : state.objects) {
        if (!impl_->objects.contains(motion.id) || !is_valid(motion)) return false;
    }
    for (const SoftMotion& motion : state.soft) {
        const SoftBody* soft = impl_->soft.find(motion.id);
        if (soft == nullptr || !is_valid(motion)) return false;
        if (soft->num_nodes() != motion.places_m.size()) return false;
    }
    for (const ObjectMotion& motion : state.objects) {
        set_motion(motion, *impl_->objects.at(motion.id));
    }
    for (const SoftMotion& motion : state.soft) {
        SoftState soft;
        soft.id = motion.id;
        soft.positions = motion.places_m;
        soft.velocities = motion.velocities;
        soft.num_torn_ticks = motion.num_torn_ticks;
        restore_soft(soft);
    }
    // after all motion is set: what is put in has its place in the broad phase from that alone
    std::vector<btRigidBody*> bodies;
    for (auto& [id, object] : impl_->objects) bodies.push_back(&object->body());
    forget_history(impl_->world, bodies);
    impl_->counters.num_ticks = state.tick;
    return true;
}

void World::set_person(const std::string& name, const PersonShape& shape) {
    impl_->people.set_person(name, shape);
}

void World::remove_person(const std::string& name) {
    if (!impl_->people.remove_person(name)) return;
    impl_->contacts.forget_person(name);
    for (auto& [id, object] : impl_->objects) {
        if (object->moves()) object->body().activate();  // what lay on the person falls
    }
}

void World::tick() {
    for (auto& [id, object] : impl_->objects) {
        if (!object->moves()) continue;
        impl_->centres_before[id] = object->centre();
    }
    impl_->world.stepSimulation(static_cast<btScalar>(impl_->options.tick_s), /*maxSubSteps=*/0);
    impl_->soft.end_tick(impl_->counters,
                         [&](const Incident& incident) { impl_->record(incident); });
    impl_->contacts.end_tick();
    impl_->guard_all();
    if (impl_->contacts.is_touched() || impl_->soft.is_touched())
        ++impl_->counters.num_contact_ticks;
    impl_->counters.num_escapes = impl_->contacts.num_escapes();
    ++impl_->counters.num_ticks;
}

void World::take_incidents(std::vector<Incident>& incidents) {
    incidents.clear();
    incidents.swap(impl_->incidents);
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

bool World::restore_soft(const SoftState& state) {
    SoftBody* soft = impl_->soft.find(state.id);
    return soft != nullptr && soft->restore(state);
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

std::uint64_t World::state_hash() const {
    std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
    const auto add = [&](double value) {
        hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211ULL;
    };
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
    return hash;
}

}  // namespace atrium::physics
