#pragma once

#include "world_server/physics/soft_pulls.hpp"

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
    double follow_hz = 15.0;         // share of its distance that the point makes good in a second
    double max_speed_mps = 8.0;      // at which the point follows
    double max_force_n = 500.0;      // of one grab,
    double max_acceleration = 80.0;  // [m/s^2] and what it does to the object at most
    double spin_damping_hz = 4.0;    // so that what hangs from a point comes to rest
    double patience_s = 2.0;         // after which a holder of whom nothing is heard lets go
    std::size_t max_grabs = 64;      // in the world,
    std::size_t max_per_holder = 4;  // and of one holder
};

/// The objects that viewers hold, each at a point that is pulled towards a goal.
///
/// Before each tick every grab gives its object the impulse that brings its point to the velocity
/// wanted there: towards the goal, slower the nearer it is, so that it arrives without swinging.
/// The impulse is bounded, so a grab cannot push through what is in the way. What lets go changes
/// no velocity: the object flies on.
///
/// A soft thing is held by a handful of its nodes, with the same limits; its points are the
/// world's when it is taken.
///
/// Points are in the frame of the body, the world's in metres. Not thread-safe; deterministic: what
/// it does depends on the calls and their order alone.
class Grabs {
public:
    explicit Grabs(const GrabOptions& options) : options_(options) {}

    /// Takes hold; where the holder holds the object already, of the new point. False: too many.
    bool hold(const std::string& holder,
              std::uint32_t object,
              const Eigen::Vector3d& point_object,
              const Eigen::Vector3d& goal_world);
    /// The same of a handful of a soft object.
    bool hold(const std::string& holder,
              std::uint32_t object,
              const SoftHandle& handle,
              const Eigen::Vector3d& goal_world);
    /// False: the holder does not hold the object.
    bool move(const std::string& holder, std::uint32_t object, const Eigen::Vector3d& goal_world);
    bool release(const std::string& holder, std::uint32_t object);
    void release_all(const std::string& holder);
    /// The object is gone.
    void forget(std::uint32_t object);

    /// What is at the other end of a grab: one of the two, or none, and it is let go.
    struct Held {
        btRigidBody* body = nullptr;  // that moves
        SoftBody* soft = nullptr;
    };
    /// One tick's impulses. `gravity` [m/s^2] is that of soft things.
    void begin_tick(const std::function<Held(std::uint32_t object)>& find,
                    const Eigen::Vector3d& gravity);

    std::size_t size() const { return grabs_.size(); }

private:
    struct Grab {
        std::string holder;
        std::uint32_t object = 0;
        Eigen::Vector3d point_object;
        SoftHandle handle;  // of a soft object, instead
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
    int patience() const;

    GrabOptions options_;
    std::vector<Grab> grabs_;  // in the order in which they were taken
};

}  // namespace atrium::physics
