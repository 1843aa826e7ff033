#pragma once

#include "world_server/physics/options/world_options.hpp"
#include "world_server/physics/soft/soft_body.hpp"
#include "world_server/physics/soft/soft_object.hpp"
#include "world_server/physics/soft/soft_soft_contacts.hpp"
#include "world_server/physics/state/world_events.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

class btRigidBody;
class btSoftBodySolver;
class btSoftRigidDynamicsWorld;

namespace atrium::physics {

class PeopleField;

/// Owns the soft objects of a Bullet world.
///
/// Pass `solver()` to the world's constructor. The world then steps the soft bodies at the end of
/// each of its steps, in ascending order of their ids.
class SoftBodies {
public:
    /// Calls `after_rigid` in each step, when the rigid bodies have moved and no soft one has.
    SoftBodies(const WorldOptions& options, std::function<void()> after_rigid);
    ~SoftBodies();
    SoftBodies(const SoftBodies&) = delete;
    SoftBodies& operator=(const SoftBodies&) = delete;

    btSoftBodySolver* solver();

    /// kInvalid: `find_problem` is not empty, or a pin names an object that `find` does not know.
    /// kWorldFull: more than `kMaxSoftNodesTotal` nodes in total.
    AddResult add(const SoftObject& object,
                  btSoftRigidDynamicsWorld& world,
                  const std::function<btRigidBody*(std::uint32_t id)>& find);
    bool remove(std::uint32_t id, btSoftRigidDynamicsWorld& world);  // false if the id is unknown
    void clear(btSoftRigidDynamicsWorld& world);
    void detach(const btRigidBody& body);
    void reset();
    /// See `World::push`.
    bool push(std::uint32_t id, const Eigen::Vector3d& impulse_ns);

    /// Call before each step of the world. Returns empty lists; add the rigid bodies near the soft
    /// bodies to them. `people` must be in its state at the start of the tick. It and the listed
    /// bodies must stay unchanged until the step is over.
    SoftSurroundings& begin_tick(const PeopleField& people);
    /// Call after each step of the world. Resets objects that are not finite or torn, handles
    /// objects that have left the world, counts and records these incidents. Returns the ids to
    /// remove.
    const std::vector<std::uint32_t>& end_tick(
        WorldCounters& counters, const std::function<void(const Incident& incident)>& record);

    bool is_touched() const;  // any soft object, by a person, in the last tick
    bool contains(std::uint32_t id) const { return bodies_.contains(id); }
    const std::map<std::uint32_t, std::unique_ptr<SoftBody>>& bodies() const { return bodies_; }
    int num_substeps_of_tick() const;
    SoftBody* find(std::uint32_t id) const;

private:
    class Solver;
    void step();
    WorldOptions options_;
    std::function<void()> after_rigid_;
    std::unique_ptr<Solver> solver_;
    std::map<std::uint32_t, std::unique_ptr<SoftBody>> bodies_;
    SoftSurroundings surroundings_;
    SoftSoftContacts contacts_{options_.soft.contacts};
    AnchoredBodies anchored_;
    std::vector<std::uint32_t> left_;    // scratch
    std::vector<SoftSurface> surfaces_;  // scratch
    std::size_t num_nodes_ = 0;
};

}  // namespace atrium::physics
