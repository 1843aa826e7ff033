#pragma once

#include "world_server/physics/options/rigid_options.hpp"
#include "world_server/physics/rigid/joint.hpp"

#include <cstdint>
#include <memory>
#include <vector>

class btDynamicsWorld;

namespace atrium::physics {

/// Owns the joints of a world.
class Joints {
public:
    /// `world` and the objects must outlive this.
    Joints(btDynamicsWorld& world, double tick_s, const JointOptions& options)
        : world_(world), tick_s_(tick_s), options_(options) {}
    ~Joints();
    Joints(const Joints&) = delete;
    Joints& operator=(const Joints&) = delete;

    /// `find_problem(joint)` must be empty; `b` is null for the world.
    void add(const Joint& joint, ObjectBody& a, ObjectBody* b);
    /// Removes the joints of an object and wakes the objects that they connected.
    void remove_of(std::uint32_t object);
    void begin_tick();

    std::size_t size() const { return joints_.size(); }
    const std::vector<std::unique_ptr<JointBody>>& all() const { return joints_; }
    /// Returns the object and all objects connected to it by joints, directly or not. Sorted.
    std::vector<std::uint32_t> group_of(std::uint32_t object) const;

private:
    btDynamicsWorld& world_;
    double tick_s_;
    JointOptions options_;
    std::vector<std::unique_ptr<JointBody>> joints_;  // in the order of `add`
};

}  // namespace atrium::physics
