#pragma once

#include "core/geometry/rigid_transform.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace atrium::physics {

class ObjectBody;

struct HoldOptions {
    double tick_s = 1.0 / 120.0;
    double follow_hz = 30.0;     // share of the remaining way per second
    double max_speed_mps = 8.0;  // slow enough that nothing is passed through
    double max_turn_rad_s = 12.0;
    double timeout_s = 2.0;  // without a message of the holder
    std::size_t max_per_holder = 4;
    std::size_t max_holds = 64;
};

enum class HoldResult : std::uint8_t { kHeld, kUnknownObject, kTooMany, kHeldByOther };

/// Carries rigid objects, fixed ones included, towards poses. A held object moves like a kinematic
/// body: it pushes others and nothing pushes it. One holder per object. When a hold ends, the
/// object is at rest.
///
/// Poses are world from object. Deterministic. Not thread-safe.
class Holds {
public:
    explicit Holds(const HoldOptions& options) : options_(options) {}

    /// Starts a hold, or gives it another goal. The caller has checked that the object exists.
    HoldResult hold(const std::string& holder,
                    std::uint32_t object,
                    const geometry::RigidTransform& goal);
    /// False if the holder does not hold the object.
    bool let_go(const std::string& holder, std::uint32_t object);
    void let_go_all(const std::string& holder);
    void forget(std::uint32_t object);
    /// Empty: nobody.
    std::string holder_of(std::uint32_t object) const;
    std::size_t size() const { return holds_.size(); }

    using Find = std::function<ObjectBody*(std::uint32_t object)>;
    /// Call before each tick. Returns true if a fixed object moves, so that sleeping objects around
    /// it must wake.
    bool begin_tick(const Find& find);
    /// Call after each tick: puts the held objects where they were meant to go.
    void end_tick(const Find& find);

private:
    struct Hold {
        std::string holder;
        std::uint32_t object = 0;
        geometry::RigidTransform goal;
        geometry::RigidTransform next;  // at the end of this tick
        Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
        Eigen::Vector3d spin = Eigen::Vector3d::Zero();
        int ticks_left = 0;
    };
    Hold* find(std::uint32_t object);
    void step(Hold& hold, const geometry::RigidTransform& from) const;

    HoldOptions options_;
    std::vector<Hold> holds_;         // in the order of the calls to `hold`
    std::vector<std::uint32_t> let_;  // objects whose hold has ended, to be put at rest
};

}  // namespace atrium::physics
