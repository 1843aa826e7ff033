#pragma once

#include "world_server/physics/grab.hpp"
#include "world_server/physics/hold.hpp"
#include "world_server/physics/people/people_contacts.hpp"
#include "world_server/physics/people/people_field.hpp"
#include "world_server/physics/rigid/flat_contacts.hpp"
#include "world_server/physics/rigid/joints.hpp"
#include "world_server/physics/rigid/load_solver.hpp"
#include "world_server/physics/rigid/mesh_contacts.hpp"
#include "world_server/physics/rigid/object_body.hpp"
#include "world_server/physics/soft/soft_bodies.hpp"
#include "world_server/physics/surroundings.hpp"
#include "world_server/physics/world.hpp"

#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

namespace atrium::physics {

/// Collision groups of the Bullet world, one bit each.
enum CollisionGroup : int { kStaticGroup = 1, kObjectGroup = 2 };

/// Parts of a world, shared by world.cpp and the files world_*.cpp.
struct World::Impl {
    explicit Impl(const WorldOptions& world_options);
    ~Impl();
    static void begin_tick(btDynamicsWorld* world, btScalar tick_s);
    ObjectBody* find(std::uint32_t id);  // null: no such rigid object
    ObjectBody* find_moving(std::uint32_t id);
    void wake_all();
    /// Wakes the objects whose boxes touch that of this body.
    void wake_near(const btRigidBody& body);
    void begin_holds();
    void end_holds();
    std::optional<IncidentKind> find_incident(ObjectBody& object);
    void limit_depenetration();
    void handle_incidents();
    void act_on(const Incident& incident);
    void record(const Incident& incident);
    bool remove(std::uint32_t id);

    WorldOptions options;
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    FlatContacts flat_contacts{dispatcher, configuration, options.rigid.flat};
    MeshContacts mesh_contacts{dispatcher, options.rigid.flat};
    btDbvtBroadphase broadphase;
    LoadSolver solver{options.rigid.load};
    SoftBodies soft{options, [this] { limit_depenetration(); }};
    btSoftRigidDynamicsWorld world{
        &dispatcher, &broadphase, &solver, &configuration, soft.solver()};
    std::map<std::uint32_t, std::unique_ptr<ObjectBody>> objects;
    PeopleField people{options.people.field};
    PeopleContacts contacts;
    Grabs grabs;
    Holds holds;
    std::map<std::uint32_t, Eigen::Vector3d> centres_before;  // dynamic objects only
    Surroundings surroundings{world, kStaticGroup, kObjectGroup};
    Joints joints{world, options.tick_s, options.rigid.joint};
    std::vector<Incident> found;      // in this tick; scratch
    std::set<std::uint32_t> handled;  // in this tick; scratch
    std::vector<Incident> incidents;
    WorldCounters counters;
};

}  // namespace atrium::physics
