#include "viewer/scene/soft_timeline.hpp"

#include "core/bus/soft_nodes.hpp"

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr std::size_t kMaxObjects = 2048;
// a larger step back means that a clock was set
constexpr std::int64_t kClockSetBackNs = 1'000'000'000;

}  // namespace

void SoftTimeline::add(bus::SoftBodyState state) {
    if (states_.size() >= kMaxObjects && !states_.contains(state.object)) return;
    auto& states = states_[state.object];
    if (!states.empty() && state.time <= states.back().time) {
        if (states.back().time.ns - state.time.ns < kClockSetBackNs) return;
        states.clear();
    }
    states.push_back(std::move(state));
    if (states.size() > max_states_) states.pop_front();
}

bool SoftTimeline::sample(std::uint32_t object,
                          Timestamp time,
                          std::vector<Eigen::Vector3f>& nodes) const {
    const auto found = states_.find(object);
    if (found == states_.end() || found->second.empty()) return false;
    const auto& states = found->second;
    auto after = std::find_if(
        states.begin(), states.end(), [&](const auto& state) { return state.time >= time; });
    if (after == states.end()) --after;
    const auto before = after == states.begin() || after->time < time ? after : std::prev(after);
    const std::size_t num_nodes = after->nodes.size();
    // a different number of nodes means that the object was replaced
    const bool is_between = before != after && before->nodes.size() == num_nodes;
    const double share = is_between ? static_cast<double>((time - before->time).count()) /
                                          static_cast<double>((after->time - before->time).count())
                                    : 1.0;
    nodes.resize(num_nodes);
    for (std::size_t i = 0; i < num_nodes; ++i) {
        const Eigen::Vector3d end = bus::node_place(*after, i);
        const Eigen::Vector3d start = is_between ? bus::node_place(*before, i) : end;
        nodes[i] = (start + share * (end - start)).cast<float>();
    }
    return true;
}

}  // namespace atrium::viewer
