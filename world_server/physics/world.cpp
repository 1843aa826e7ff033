#include "world_server/physics/world.hpp"

#include "world_server/physics/object_body.hpp"
#include "world_server/physics/people_contacts.hpp"
#include "world_server/physics/people_field.hpp"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <map>

namespace atrium::physics {
namespace {

/// Collision groups of the Bullet world, one bit each.
enum CollisionGroup : int { kStillGroup = 1, kObjectGroup = 2 };

// Overlap above which Bullet separates without adding velocity; its default of 4 cm makes whatever
// is pressed by a hand pop away.
constexpr float kPlainContactM = 0.002F;
constexpr int kSolverIterations = 20;

btVector3 to_bullet(const Eigen::Vector3d& v) {
    return btVector3(btScalar(v.x()), btScalar(v.y()), btScalar(v.z()));
}

}  // namespace

struct World::Impl {
    explicit Impl(const WorldOptions& world_options);
    ~Impl();
    static void begin_tick(btDynamicsWorld* world, btScalar tick_s);
    void guard(ObjectBody& object);

    WorldOptions options;
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    std::map<std::uint32_t, std::unique_ptr<ObjectBody>> objects;
    PeopleField people;
    PeopleContacts contacts;
    std::map<std::uint32_t, Eigen::Vector3d> positions_before;  // of the objects that move
    WorldCounters counters;
};

World::Impl::Impl(const WorldOptions& world_options)
    : options(world_options),
      contacts(dispatcher,
               {.friction = world_options.person_friction,
                .restitution = world_options.person_restitution,
                .escape_mps = world_options.escape_mps}) {
    assert(options.tick_s > 0.0 && options.max_speed_mps > 0.0);
    world.setGravity(to_bullet(options.gravity));
    world.getSolverInfo().m_splitImpulsePenetrationThreshold = -kPlainContactM;
    // what is clasped between two palms needs force from both and friction along both tangents
    world.getSolverInfo().m_numIterations = kSolverIterations;
    world.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    world.getDispatchInfo().m_deterministicOverlappingPairs = true;
    world.setInternalTickCallback(&Impl::begin_tick, this, /*isPreTick=*/true);
}

World::Impl::~Impl() {
    for (auto& [id, object] : objects) world.removeRigidBody(&object->body());
}

void World::Impl::begin_tick(btDynamicsWorld* world, btScalar tick_s) {
    Impl& self = *static_cast<Impl*>(world->getWorldUserInfo());
    self.people.begin_tick(tick_s);
    self.contacts.begin_tick(self.people, tick_s);
}

void World::Impl::guard(ObjectBody& object) {
    if (!object.is_finite()) {
        ++counters.num_not_finite;
        object.put_back();
        return;
    }
    if (object.body().isActive()) {
        object.limit_motion(positions_before[object.object().id], options);
    }
    const Eigen::Vector3d position = object.state().world_from_object.translation;
    const bool strayed =
        position.z() < options.lowest_z_m || position.cwiseAbs().maxCoeff() > options.half_extent_m;
    if (strayed) {
        ++counters.num_strays;
        object.put_back();
    }
}

World::World(const WorldOptions& options) : impl_(std::make_unique<Impl>(options)) {}
World::~World() = default;

AddResult World::add(const RigidObject& object) {
    if (find_problem(object)) return AddResult::kInvalid;
    if (impl_->objects.contains(object.id)) return AddResult::kIdInUse;
    if (impl_->objects.size() >= impl_->options.max_objects) return AddResult::kWorldFull;
    auto body = std::make_unique<ObjectBody>(object, impl_->options);
    const int group = body->moves() ? kObjectGroup : kStillGroup;
    const int mask = body->moves() ? kStillGroup | kObjectGroup : kObjectGroup;
    impl_->world.addRigidBody(&body->body(), group, mask);
    if (body->moves()) impl_->contacts.add(object.id, body->body());
    impl_->objects.emplace(object.id, std::move(body));
    return AddResult::kAdded;
}

bool World::remove(std::uint32_t id) {
    const auto found = impl_->objects.find(id);
    if (found == impl_->objects.end()) return false;
    impl_->contacts.remove(id);
    impl_->world.removeRigidBody(&found->second->body());
    impl_->objects.erase(found);
    impl_->positions_before.erase(id);
    // what rested on it must not go on sleeping in the air
    for (auto& [other, object] : impl_->objects) {
        if (object->moves()) object->body().activate();
    }
    return true;
}

void World::reset() {
    btOverlappingPairCache& pairs = *impl_->broadphase.getOverlappingPairCache();
    for (auto& [id, object] : impl_->objects) {
        pairs.cleanProxyFromPairs(object->body().getBroadphaseHandle(), &impl_->dispatcher);
        object->put_back();
    }
}

bool World::push(std::uint32_t id, const Eigen::Vector3d& impulse_ns) {
    const auto found = impl_->objects.find(id);
    if (found == impl_->objects.end() || !found->second->moves()) return false;
    if (!impulse_ns.allFinite()) return false;
    found->second->body().activate(true);
    found->second->body().applyCentralImpulse(to_bullet(impulse_ns));
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
        impl_->positions_before[id] = object->state().world_from_object.translation;
    }
    impl_->world.stepSimulation(static_cast<btScalar>(impl_->options.tick_s), /*maxSubSteps=*/0);
    for (auto& [id, object] : impl_->objects) {
        if (object->moves()) impl_->guard(*object);
    }
    impl_->contacts.end_tick();
    if (impl_->contacts.is_touched()) ++impl_->counters.num_contact_ticks;
    impl_->counters.num_escapes = impl_->contacts.num_escapes();
    ++impl_->counters.num_ticks;
}

void World::get_states(std::vector<RigidState>& states) const {
    states.clear();
    for (const auto& [id, object] : impl_->objects) states.push_back(object->state());
}

const WorldCounters& World::counters() const { return impl_->counters; }
std::size_t World::num_objects() const { return impl_->objects.size(); }
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
    return hash;
}

}  // namespace atrium::physics
