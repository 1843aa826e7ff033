#pragma once

#include "world_server/physics/soft_body.hpp"
#include "world_server/physics/soft_object.hpp"
#include "world_server/physics/soft_pairs.hpp"
#include "world_server/physics/world.hpp"

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

/// The soft objects of a Bullet world.
///
/// `solver` is given to the world when that is made, which then has the soft bodies stepped at the
/// end of each of its steps, in the order of their ids.
class SoftBodies {
public:
    explicit SoftBodies(const WorldOptions& options);
    ~SoftBodies();
    SoftBodies(const SoftBodies&) = delete;
    SoftBodies& operator=(const SoftBodies&) = delete;

    btSoftBodySolver* solver();

    /// kInvalid: see `find_problem`, or tied to an object that `find` does not know. kWorldFull:
    /// more nodes than `kMaxSoftNodesTotal`.
    AddResult add(const SoftObject& object,
                  btSoftRigidDynamicsWorld& world,
                  const std::function<btRigidBody*(std::uint32_t id)>& find);
    bool remove(std::uint32_t id, btSoftRigidDynamicsWorld& world);  // false: not there
    void clear(btSoftRigidDynamicsWorld& world);
    void untie(const btRigidBody& body);
    void reset();
    /// As `World::push`.
    bool push(std::uint32_t id, const Eigen::Vector3d& impulse_ns);

    /// To be called before each step of the world. `people` is as at the beginning of the tick and
    /// stays so until the step is over, as do the rigid bodies that the caller puts into the list
    /// that is returned, empty.
    std::vector<btRigidBody*>& begin_tick(const PeopleField& people);
    /// To be called after each step of the world: puts back what is not a number, what is torn and
    /// what has left the world, counts it and says so. Returns those that are to be removed
    /// instead.
    const std::vector<std::uint32_t>& end_tick(
        WorldCounters& counters, const std::function<void(const Incident& incident)>& record);

    bool is_touched() const;  // any of them, by a person, in the last tick
    bool contains(std::uint32_t id) const { return bodies_.contains(id); }
    const std::map<std::uint32_t, std::unique_ptr<SoftBody>>& bodies() const { return bodies_; }
    SoftBody* find(std::uint32_t id) const;

private:
    class Solver;
    void step();
    WorldOptions options_;
    std::unique_ptr<Solver> solver_;
    std::map<std::uint32_t, std::unique_ptr<SoftBody>> bodies_;
    SoftSurroundings surroundings_;
    SoftPairs pairs_;
    TiedBodies tied_;
    std::vector<std::uint32_t> left_;    // scratch
    std::vector<SoftSurface> surfaces_;  // scratch
    std::size_t num_nodes_ = 0;
};

}  // namespace atrium::physics
