#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "world_server/physics/joint.hpp"
#include "world_server/physics/person_shape.hpp"
#include "world_server/physics/rigid_object.hpp"
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

/// What becomes of an object whose centre of mass leaves the world's box.
enum class LeavePolicy : std::uint8_t {
    kReset,   // back to where it started
    kRemove,  // it is gone
    kBounce   // it cannot: the box has walls; what gets through one is put back
};

struct WorldOptions {
    double tick_s = 1.0 / 120.0;
    Eigen::Vector3d gravity{0.0, 0.0, -9.81};  // [m/s^2]
    std::size_t max_objects = 256;
    double half_extent_m = 20.0;          // the world's box: as far as this from the origin,
    double lowest_z_m = -1.0;             // but no lower than this;
    std::optional<geometry::Aabb> box{};  // or this one in place of the two
    LeavePolicy leaving = LeavePolicy::kReset;
    double max_speed_mps = 15.0;         // of an object
    double max_spin_rad_s = 60.0;        // of an object
    double max_depenetration_mps = 3.0;  // at which objects that overlap are moved apart
    double escape_mps = 1.5;             // at which an object inside a person is led out
    double person_friction = 2.0;        // see PeopleContactOptions
    double person_restitution = 0.2;
};

/// What a person is to the physics at one moment.
struct PersonNow {
    std::string name;
    std::shared_ptr<const std::vector<MovingSurfel>> surfels;
    float share_to_go = 0.0F;  // of the way of each surfel from `from` to `position`
    Timestamp capture_time;    // when it was at `position`
    struct Touch {
        std::uint32_t object = 0;
        Eigen::Vector3f point;  // [m] world, on the person
    };
    std::vector<Touch> touches;  // in the last tick, with rigid objects
};

struct SoftObject;
struct SoftTopology;

geometry::Aabb box_of(const WorldOptions& options);

/// What the world did to an object on its own.
enum class IncidentKind : std::uint8_t {
    kNotFinite,  // its state was not a number: put back
    kRunaway,    // in one tick it became faster than anything makes it: put back
    kTorn,       // it came off what it is joined to: put back
    kLeft,       // it left the world's box: put back
    kRemoved     // it left the world's box: removed
};
/// "was not a number, and was put back"
std::string_view describe(IncidentKind kind);

struct Incident {
    std::uint32_t object = 0;
    IncidentKind kind = IncidentKind::kLeft;
};

enum class AddResult : std::uint8_t { kAdded, kIdInUse, kWorldFull, kInvalid };

/// Running counts since the construction.
struct WorldCounters {
    std::uint64_t num_ticks = 0;
    std::uint64_t num_contact_ticks = 0;  // with at least one contact of a person and an object
    std::uint64_t num_soft_contact_ticks = 0;  // of these, of a person and a soft object
    std::uint64_t num_strays = 0;              // objects that left the world's box
    std::uint64_t num_not_finite = 0;          // objects whose state was not a number, put back
    std::uint64_t num_runaways = 0;            // objects of an absurd speed, put back
    std::uint64_t num_torn = 0;     // objects torn from what they are joined to, or soft ones
                                    // out of all shape, put back
    std::uint64_t num_escapes = 0;  // objects that were found inside a person
};

/// Objects, a still surrounding, and people, in Bullet.
///
/// A person is a volume whose surface is sampled by moving surfels (see `PeopleField`). When a
/// shape arrives, each surfel is set back to where the mesh before had it and then moves forward
/// for the shape's period, so that surfaces sweep from mesh to mesh without a gap and stop where
/// the mesh was captured, unless the next one has come by then. A person thus lags by one mesh
/// period, never overshoots, and yields to nothing.
///
/// An object whose state is not a number, or that became absurdly fast, is put back to where it
/// started, and with it all that it is joined to; the rest of the world goes on.
///
/// Deterministic: equal calls give equal states. Not thread-safe; creates no threads.
class World {
public:
    explicit World(const WorldOptions& options);
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    /// kInvalid: see `find_problem`.
    AddResult add(const RigidObject& object);
    /// Ids are those of all objects, rigid and soft. See soft_object.hpp; kWorldFull: nodes.
    AddResult add_soft(const SoftObject& object);
    /// With its joints. False: not there.
    bool remove(std::uint32_t id);
    /// False, and nothing added, where it has a problem (`find_problem`), its objects are not
    /// there, or neither of them moves.
    bool add_joint(const Joint& joint);
    /// See `Surroundings::add`.
    bool add_still(const StillMesh& mesh);
    /// Wakes it. False: not there, it does not move, or a number is not finite.
    bool set_state(const RigidState& state);
    /// Puts every object back to where it started, at rest.
    void reset();
    /// `impulse_ns` [N s] acts at the centre of mass. False: not there, or it does not move.
    bool push(std::uint32_t id, const Eigen::Vector3d& impulse_ns);

    /// Lets `holder` hold an object at a point of it [m, in its frame; of a soft one in the world]
    /// and pull that towards a goal [m, world] (grab.hpp). False: no such object that moves, or too
    /// many are held.
    bool grab(const std::string& holder,
              std::uint32_t id,
              const Eigen::Vector3d& point_object,
              const Eigen::Vector3d& goal_world);
    /// False: the holder does not hold it.
    bool move_grab(const std::string& holder, std::uint32_t id, const Eigen::Vector3d& goal_world);
    bool release(const std::string& holder, std::uint32_t id);
    void release_all(const std::string& holder);
    std::size_t num_grabs() const;

    void get_state(WorldState& state) const;
    /// Goes on from `state`: equal states and equal calls from there on give equal states, whatever
    /// was before, provided that nobody is in the world and nothing held at that moment. Objects
    /// that `state` does not name stay where they are. False, and nothing is changed, where it
    /// names one that is not there, or a number is out of range.
    bool set_state(const WorldState& state);

    /// The newest shape of a person takes the place of the one before.
    void set_person(const std::string& name, const PersonShape& shape);
    void remove_person(const std::string& name);

    /// Everybody who is there, in the order of their names. Copies no surfels, and uses the memory
    /// of `people` again.
    void get_people(std::vector<PersonNow>& people) const;

    /// One step of `tick_s`.
    void tick();

    /// What the world did on its own since the last call, oldest first; at most 256 are kept.
    void take_incidents(std::vector<Incident>& incidents);

    /// Of all objects, in the order of their ids.
    void get_states(std::vector<RigidState>& states) const;
    /// The places of a soft object's nodes [m, world], in memory that is used again. False: no such
    /// soft object.
    bool get_soft_nodes(std::uint32_t id, std::vector<Eigen::Vector3f>& nodes) const;
    /// Of all soft objects, in the order of their ids: what `restore_soft` takes. The vectors'
    /// memory is used again.
    void get_soft_states(std::vector<SoftState>& states) const;
    /// False, and nothing is changed: no such soft object, not its number of nodes, or not finite.
    bool restore_soft(const SoftState& state);
    /// Null: no such soft object. Valid until it is removed.
    const SoftTopology* soft_topology(std::uint32_t id) const;
    std::size_t num_soft_nodes(std::uint32_t id) const;  // 0: no such soft object
    const WorldCounters& counters() const;
    std::size_t num_objects() const;
    std::size_t num_joints() const;
    std::size_t num_people() const;
    std::size_t num_surfels() const;  // of all people
    /// Of every object's pose and velocities, and every soft node's, bit by bit.
    std::uint64_t state_hash() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::physics
