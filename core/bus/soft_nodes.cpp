#include "core/bus/soft_nodes.hpp"

#include "core/bus/lattice.hpp"
#include "core/bus/limits.hpp"

#include <cassert>

namespace atrium::bus {

void quantise(std::span<const Eigen::Vector3f> places, SoftBodyState& out) {
    assert(places.size() <= kMaxSoftNodes);
    out.nodes.clear();
    if (places.empty()) return;
    const Lattice lattice = lattice_around(places);
    out.origin_m = lattice.origin_m;
    out.step_m = lattice.step_m;
    for (const Eigen::Vector3f& place : places) out.nodes.push_back(lattice.quantised(place));
}

}  // namespace atrium::bus
