#pragma once

#include "world_server/physics/soft/soft_motors.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

class btRigidBody;

namespace atrium::physics {

class SoftBody;

struct GrabOptions {
    double tick_s = 1.0 / 120.0;
    double follow_hz = 15.0;         // gain: wanted speed per distance to the goal [1/s]
    double max_speed_mps = 8.0;      // limit on the speed of the held point
    double max_force_n = 500.0;      // limit on the force of one grab
    double max_acceleration = 80.0;  // [m/s^2] limit on what one grab does to the object
    double spin_damping_hz = 4.0;    // damps the spin: a hanging object comes to rest
    double timeout_s = 2.0;          // a grab ends if its holder sends nothing for this long
    std::size_t max_grabs = 64;      // in the world
    std::size_t max_per_holder = 4;  // of one holder
};

/// Pulls held objects towards goals. Each grab holds one object at one point.
///
/// Before each tick, a grab gives its object the impulse that brings the held point to the wanted
/// velocity. That velocity points to the goal and falls with the distance, which avoids overshoot.
/// The impulse is bounded, so a grab cannot push an object through an obstacle. Releasing changes
/// no velocity: the object flies on.
///
/// A grab holds a soft object by a group of its nodes (`SoftHandle`), with the same limits. The
/// held point of a soft object is given in the world frame at the moment of the grab.
///
/// Points are in the object's body frame, goals in the world frame [m]. Deterministic: results
/// depend only on the calls and their order. Not thread-safe.
class Grabs {
public:
    explicit Grabs(const GrabOptions& options) : options_(options) {}

    /// Starts a grab. If the holder already holds the object, moves the grab to the new point.
    /// False if there are too many grabs.
    bool hold(const std::string& holder,
              std::uint32_t object,
              const Eigen::Vector3d& point_object,
              const Eigen::Vector3d& goal_world);
    /// Like the above, for a soft object.
    bool hold(const std::string& holder,
              std::uint32_t object,
              const SoftHandle& handle,
              const Eigen::Vector3d& goal_world);
    /// False if the holder does not hold the object.
    bool move(const std::string& holder, std::uint32_t object, const Eigen::Vector3d& goal_world);
    bool release(const std::string& holder, std::uint32_t object);
    void release_all(const std::string& holder);
    /// Ends all grabs of an object that is about to be removed.
    void forget(std::uint32_t object);

    /// The held object: rigid or soft. If both are null, the grab ends.
    struct Held {
        btRigidBody* body = nullptr;  // not static
        SoftBody* soft = nullptr;
    };
    /// Applies the impulses of one tick. `gravity` [m/s^2] is used for soft objects.
    void begin_tick(const std::function<Held(std::uint32_t object)>& find,
                    const Eigen::Vector3d& gravity);

    std::size_t size() const { return grabs_.size(); }

private:
    struct Grab {
        std::string holder;
        std::uint32_t object = 0;
        Eigen::Vector3d point_object;
        SoftHandle handle;  // replaces point_object for a soft object
        Eigen::Vector3d goal_world;
        int ticks_left = 0;
    };
    bool hold(Grab grab);
    Grab* find(const std::string& holder, std::uint32_t object);
    void pull(const Grab& grab, btRigidBody& body) const;
    void pull(const Grab& grab, SoftBody& soft, double gravity) const;
    double max_force_n(double mass_kg) const;
    Eigen::Vector3d wanted_velocity(const Eigen::Vector3d& way,
                                    double mass_kg,
                                    double gravity) const;
    int timeout_ticks() const;

    GrabOptions options_;
    std::vector<Grab> grabs_;  // in the order of the calls to `hold`
};

}  // namespace atrium::physics
