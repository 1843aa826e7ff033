#pragma once

#include "core/bus/messages.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <deque>
#include <map>
#include <vector>

namespace atrium::viewer {

/// Where the nodes of soft objects are at any moment between two SoftBodyStates. Not thread-safe.
class SoftTimeline {
public:
    /// `max_states` of each object are kept.
    explicit SoftTimeline(std::size_t max_states = 8) : max_states_(max_states) {}

    /// One that is older than the newest is dropped, or ends what was before where the server's
    /// clock was set back.
    void add(bus::SoftBodyState state);
    void remove(std::uint32_t object) { states_.erase(object); }
    void clear() { states_.clear(); }

    /// Nodes at a time of the world's clock [m, world]: between two states on a straight line, and
    /// where the first or last one has them outside. False: nothing is known of the object.
    bool sample(std::uint32_t object, Timestamp time, std::vector<Eigen::Vector3f>& nodes) const;

private:
    std::size_t max_states_;
    std::map<std::uint32_t, std::deque<bus::SoftBodyState>> states_;  // rising times, a few each
};

}  // namespace atrium::viewer
