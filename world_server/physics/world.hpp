#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "world_server/physics/people/people_options.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/physics/rigid/joint.hpp"
#include "world_server/physics/rigid/rigid_object.hpp"
#include "world_server/physics/rigid/rigid_options.hpp"
#include "world_server/physics/soft/soft_options.hpp"
#include "world_server/physics/surroundings.hpp"
#include "world_server/physics/world_state.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::physics {

struct RigidState {
    std::uint32_t id = 0;
    geometry::RigidTransform world_from_object;
    Eigen::Vector3d linear_velocity = Eigen::Vector3d::Zero();   // [m/s] world
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // [rad/s] world
};

/// Action for an object whose centre of mass leaves the world's box.
enum class LeavePolicy : std::uint8_t {
    kReset,   // returns to its start pose
    kRemove,  // is removed
    // cannot leave: the box has walls; an object that gets through one returns to its start
    kBounce
};

/// Options and tuned constants of a world. Those of people, rigid and soft objects are beside their
/// code.
struct WorldOptions {
    double tick_s = 1.0 / 120.0;
    Eigen::Vector3d gravity{0.0, 0.0, -9.81};  // [m/s^2]
    std::size_t max_objects = 256;
    double half_extent_m = 20.0;          // half size of the world's box around the origin
    double lowest_z_m = -1.0;             // lower end of the box
    std::optional<geometry::Aabb> box{};  // replaces the two above
    LeavePolicy leaving = LeavePolicy::kReset;
    double max_speed_mps = 15.0;         // of an object
    double max_spin_rad_s = 60.0;        // of an object
    double max_depenetration_mps = 3.0;  // speed at which overlapping objects separate
    // Overlap above which Bullet separates without adding velocity. Bullet's default of 4 cm makes
    // an object pressed by a hand pop away.
    float plain_contact_m = 0.002F;
    int solver_iterations = 20;  // an object clasped between two palms needs force from both
    double wall_friction = 0.5;  // of the box, for LeavePolicy::kBounce
    double wall_restitution = 0.5;
    // An object beyond these limits returns to its start. No cause adds more than a few times
    // max_speed_mps in one tick.
    double runaway_factor = 4.0;  // speed, in max_speed_mps
    double torn_m = 0.25;         // gap of a joint
    double behind_wall_m = 0.5;   // LeavePolicy::kBounce: distance outside the box
    PeopleOptions people{};
    RigidOptions rigid{};
    SoftOptions soft{};
};

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

geometry::Aabb box_of(const WorldOptions& options);

/// Correction that the world made to an object.
enum class IncidentKind : std::uint8_t {
    kNotFinite,  // state not finite: returned to its start
    kRunaway,    // faster than any cause explains within one tick: returned to its start
    kTorn,       // separated at a joint: returned to its start
    kLeft,       // left the world's box: returned to its start
    kRemoved     // left the world's box: removed
};
/// Returns a predicate for log lines, such as "left the world and was removed".
std::string_view describe(IncidentKind kind);

struct Incident {
    std::uint32_t object = 0;
    IncidentKind kind = IncidentKind::kLeft;
};

enum class AddResult : std::uint8_t { kAdded, kIdInUse, kWorldFull, kInvalid };

/// Counts since construction.
struct WorldCounters {
    std::uint64_t num_ticks = 0;
    // with at least one contact between a person and an object
    std::uint64_t num_contact_ticks = 0;
    std::uint64_t num_soft_contact_ticks = 0;  // of these, with a soft object
    std::uint64_t num_strays = 0;              // objects that left the world's box
    std::uint64_t num_not_finite = 0;          // objects with a state that was not finite
    std::uint64_t num_runaways = 0;            // objects that became far too fast
    std::uint64_t num_torn = 0;     // objects separated at a joint, or soft objects out of shape
    std::uint64_t num_escapes = 0;  // objects found inside a person
};

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
    void release_all(const std::string& holder);
    std::size_t num_grabs() const;

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
