#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "world_server/physics/hold.hpp"
#include "world_server/physics/options/world_options.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/physics/rigid/joint.hpp"
#include "world_server/physics/rigid/rigid_object.hpp"
#include "world_server/physics/state/world_events.hpp"
#include "world_server/physics/state/world_state.hpp"
#include "world_server/physics/surroundings.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::physics {

/// State of a person in the physics at one moment.
struct PersonSnapshot {
    std::string name;
    std::shared_ptr<const std::vector<MovingSurfel>> surfels;
    float share_to_go = 0.0F;  // remaining share of each surfel's way from `from` to `position`
    Timestamp capture_time;    // time at which the surfels are at `position`
    struct Touch {
        std::uint32_t object = 0;
        Eigen::Vector3f point;  // [m] world, on the person
    };
    std::vector<Touch> touches;  // touches with rigid objects in the last tick
};

struct SoftObject;
struct SoftTopology;

/// Simulates rigid and soft objects, static scenery and people with Bullet.
///
/// A person is a volume whose surface is sampled by moving surfels (see `PeopleField`). When a
/// shape arrives, each surfel returns to its place on the previous mesh and then moves forward for
/// the shape's period. Surfaces thus sweep from mesh to mesh without gaps. They stop at the
/// captured place if the next mesh is late. A person therefore lags by one mesh period, never
/// overshoots, and yields to nothing.
///
/// An object with a state that is not finite or with an absurd speed returns to its start pose,
/// together with everything joined to it. The rest of the world continues.
///
/// Deterministic: equal calls give equal states. Not thread-safe. Creates no threads.
class World {
public:
    explicit World(const WorldOptions& options);
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    /// kInvalid: `find_problem` is not empty.
    AddResult add(const RigidObject& object);
    /// See soft_object.hpp. Rigid and soft objects share one set of ids. kWorldFull: too many
    /// nodes.
    AddResult add_soft(const SoftObject& object);
    /// Removes an object and its joints. False if the id is unknown.
    bool remove(std::uint32_t id);
    /// Returns false and adds nothing if the joint has a problem (`find_problem`), an object is
    /// missing, or both objects are static.
    bool add_joint(const Joint& joint);
    /// Adds static scenery; see `Surroundings::add`.
    bool add_static(const StaticMesh& mesh);
    /// Sets pose and velocities of an object and wakes it. False if the id is unknown, the object
    /// is static, or a number is not finite.
    bool set_state(const RigidState& state);
    /// Returns every object to its start pose, at rest.
    void reset();
    /// Applies `impulse_ns` [N s] at the centre of mass. False if the id is unknown or the object
    /// is static.
    bool push(std::uint32_t id, const Eigen::Vector3d& impulse_ns);

    /// Starts a grab (grab.hpp): `holder` holds an object at a point [m; rigid: object frame, soft:
    /// world] and pulls that point towards a goal [m, world]. False if there is no such dynamic
    /// object or there are too many grabs.
    bool grab(const std::string& holder,
              std::uint32_t id,
              const Eigen::Vector3d& point_object,
              const Eigen::Vector3d& goal_world);
    /// False if the holder does not hold the object.
    bool move_grab(const std::string& holder, std::uint32_t id, const Eigen::Vector3d& goal_world);
    bool release(const std::string& holder, std::uint32_t id);
    /// Also lets go of held objects.
    void release_all(const std::string& holder);
    std::size_t num_grabs() const;

    /// Carries an object towards a pose (hold.hpp). The goal must be finite.
    HoldResult hold(const std::string& holder,
                    std::uint32_t id,
                    const geometry::RigidTransform& goal);
    bool let_go(const std::string& holder, std::uint32_t id);
    std::string holder_of(std::uint32_t id) const;  // empty: nobody holds it
    /// Puts a rigid object at a pose, at rest; fixed objects too. False if the id is unknown.
    bool place(std::uint32_t id, const geometry::RigidTransform& pose);
    /// Sets the pose to which `reset` returns an object. False if the id is unknown.
    bool set_start(std::uint32_t id, const geometry::RigidTransform& pose);
    /// Gives the rigid object of that id other size, mass, friction and restitution. Keeps pose,
    /// velocity and hold; an object that becomes fixed stops. False if the id is unknown, the
    /// object is not valid, or it is joined and its size changes or it becomes fixed or movable.
    bool change(const RigidObject& object);
    /// True if joints or soft objects are attached to it.
    bool is_joined(std::uint32_t id) const;
    const RigidObject* object(std::uint32_t id) const;  // null: no such rigid object
    std::optional<geometry::RigidTransform> pose_of(std::uint32_t id) const;

    void get_state(WorldState& state) const;
    /// Continues from `state`. Equal states and equal later calls give equal states, whatever
    /// happened before, provided that at this moment no person is in the world and nothing is
    /// grabbed. Objects without an entry keep their place. Returns false and changes nothing if an
    /// id is unknown or a number is out of range.
    bool set_state(const WorldState& state);

    /// Replaces the shape of a person.
    void set_person(const std::string& name, const PersonShape& shape);
    void remove_person(const std::string& name);

    /// Writes all people in the order of their names. Copies no surfels. Reuses the memory of
    /// `people`.
    void get_people(std::vector<PersonSnapshot>& people) const;

    /// Advances the world by `tick_s`.
    void tick();

    /// Takes the incidents since the last call, oldest first. At most 256 are kept.
    void take_incidents(std::vector<Incident>& incidents);

    /// Writes the states of all rigid objects in the order of their ids.
    void get_states(std::vector<RigidState>& states) const;
    /// Writes the node positions of a soft object [m, world]. Reuses the memory. False if there is
    /// no such soft object.
    bool get_soft_nodes(std::uint32_t id, std::vector<Eigen::Vector3f>& nodes) const;
    /// Writes the states of all soft objects in the order of their ids, as input for
    /// `restore_soft`. Reuses the memory of the vectors.
    void get_soft_states(std::vector<SoftState>& states) const;
    /// Returns false and changes nothing if there is no such soft object, the number of nodes
    /// differs, or a number is not finite.
    bool restore_soft(const SoftState& state);
    /// Null if there is no such soft object. Valid until its removal.
    const SoftTopology* soft_topology(std::uint32_t id) const;
    std::size_t num_soft_nodes(std::uint32_t id) const;  // 0 if there is no such soft object
    const WorldCounters& counters() const;
    std::size_t num_objects() const;
    std::size_t num_joints() const;
    std::size_t num_people() const;
    std::size_t num_surfels() const;  // of all people
    /// Returns a hash over the bits of all poses and velocities of objects and soft nodes.
    std::uint64_t state_hash() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::physics
