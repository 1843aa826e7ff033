#pragma once

#include "core/bus/messages.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <deque>
#include <map>
#include <vector>

namespace atrium::viewer {

/// Interpolates the nodes of soft objects between two SoftBodyStates. Not thread-safe.
class SoftTimeline {
public:
    /// Keeps `max_states` states per object.
    explicit SoftTimeline(std::size_t max_states = 8) : max_states_(max_states) {}

    /// Adds a state. Drops one that is not newer than the last, unless it is so much older that the
    /// server's clock was set back: then the former states are dropped.
    void add(bus::SoftBodyState state);
    void remove(std::uint32_t object) { states_.erase(object); }
    void clear() { states_.clear(); }

    /// Writes the nodes at `time` on the world's clock [m, world]: linear between two states,
    /// clamped to the first and last state. Returns false if the object is unknown.
    bool sample(std::uint32_t object, Timestamp time, std::vector<Eigen::Vector3f>& nodes) const;

private:
    std::size_t max_states_;
    /// Rising times, at most max_states_ per object.
    std::map<std::uint32_t, std::deque<bus::SoftBodyState>> states_;
};

}  // namespace atrium::viewer
