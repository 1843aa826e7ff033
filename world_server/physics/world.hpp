#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "world_server/physics/person_shape.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::physics {

enum class ObjectShape : std::uint8_t { kBox, kSphere, kCylinder, kCapsule, kPlane };

struct RigidObject {
    std::uint32_t id = 0;
    ObjectShape shape = ObjectShape::kBox;
    /// [m] box: full extents; sphere: diameter thrice; cylinder, capsule: diameter, diameter,
    /// height along local z (a capsule's height includes its caps); plane: infinite, through the
    /// origin, normal +z, unused.
    Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
    double mass_kg = 0.0;  // 0: does not move; a plane must not
    double friction = 0.6;
    double restitution = 0.2;
    geometry::RigidTransform world_from_object{};  // where it starts, and where `reset` puts it
};

/// What is wrong with an object, and what would be right.
struct ObjectProblem {
    std::string_view field;
    std::string_view allowed;
};

/// A number is not finite, a size is outside 1 cm .. 20 m or does not fit the shape, a mass is
/// outside 0 .. 10 t, a density outside 1 .. 30000 kg/m^3, or a plane has a mass.
std::optional<ObjectProblem> find_problem(const RigidObject& object);

struct RigidState {
    std::uint32_t id = 0;
    geometry::RigidTransform world_from_object;
    Eigen::Vector3d linear_velocity = Eigen::Vector3d::Zero();   // [m/s] world
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // [rad/s] world
};

struct WorldOptions {
    double tick_s = 1.0 / 120.0;
    Eigen::Vector3d gravity{0.0, 0.0, -9.81};  // [m/s^2]
    std::size_t max_objects = 256;
    double half_extent_m = 20.0;         // an object that is further out than this,
    double lowest_z_m = -1.0;            // or lower than this, goes back to where it started
    double max_speed_mps = 15.0;         // of an object
    double max_spin_rad_s = 60.0;        // of an object
    double max_depenetration_mps = 3.0;  // at which objects that overlap are moved apart
    double escape_mps = 1.5;             // at which an object inside a person is led out
    double person_friction = 1.3;        // see PeopleContactOptions
    double person_restitution = 0.2;
};

enum class AddResult : std::uint8_t { kAdded, kIdInUse, kWorldFull, kInvalid };

/// Running counts since the construction.
struct WorldCounters {
    std::uint64_t num_ticks = 0;
    std::uint64_t num_contact_ticks = 0;  // with at least one contact of a person and an object
    std::uint64_t num_strays = 0;         // objects that left the world and were put back
    std::uint64_t num_not_finite = 0;     // objects whose state was not a number, put back
    std::uint64_t num_escapes = 0;        // objects that were found inside a person
};

/// Objects, a still surrounding, and people, in Bullet.
///
/// A person is a volume whose surface is sampled by moving surfels (see `PeopleField`). When a
/// shape arrives, each surfel is set back to where the mesh before had it and then moves forward
/// for the shape's period, so that surfaces sweep from mesh to mesh without a gap and stop where
/// the mesh was captured, unless the next one has come by then. A person thus lags by one mesh
/// period, never overshoots, and yields to nothing.
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
    bool remove(std::uint32_t id);  // false: not there
    /// Puts every object back to where it started, at rest.
    void reset();
    /// `impulse_ns` [N s] acts at the centre of mass. False: not there, or it does not move.
    bool push(std::uint32_t id, const Eigen::Vector3d& impulse_ns);

    /// The newest shape of a person takes the place of the one before.
    void set_person(const std::string& name, const PersonShape& shape);
    void remove_person(const std::string& name);

    /// One step of `tick_s`.
    void tick();

    /// Of all objects, in the order of their ids.
    void get_states(std::vector<RigidState>& states) const;
    const WorldCounters& counters() const;
    std::size_t num_objects() const;
    std::size_t num_people() const;
    std::size_t num_surfels() const;  // of all people
    /// Of every object's pose and velocities, bit by bit.
    std::uint64_t state_hash() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::physics
