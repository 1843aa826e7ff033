#include "site_node/hull/strip_chart.hpp"

#include <algorithm>

namespace atrium::hull {

void StripChart::find_limits() {
    faces_.assign(1, {-kInfinity, kInfinity});
    for (const Bundle& bundle : bundles()) find_ranges(bundle);
    limits_ = faces_.empty() ? Range{kInfinity, -kInfinity}
                             : Range{faces_.back().low, faces_.front().high};
}

// Intersects `faces_` with the ranges in which camera `bundle.view` may see somebody.
void StripChart::find_ranges(const Bundle& bundle) {
    const std::uint32_t num_at_start = bundle.num_at_start;
    const bool carves_near = (verdict_at_centre_.carved >> bundle.view & 1) != 0;
    if (all_carve_ && num_at_start > 2 && bundle.has_only_chains &&
        find_ranges_between_chains(bundle, carves_near)) {
        restrict_faces();
        return;
    }
    Range range{low(bundle.bounds), high(bundle.bounds)};
    bool carves_far = carves_near;
    if (all_carve_) {
        carves_far ^= (num_at_start & 1) != 0;
    } else {
        range = carving_range(bundle);
        for (std::uint32_t s = 0; s < bundle.num_spans; ++s) {
            const Span& span = bundle.spans[s];
            if (span.from < num_at_start) carves_far ^= carves(span.strip);
        }
    }
    if (!carves_far) range.low = -kInfinity;
    if (!carves_near) range.high = kInfinity;
    if (faces_.size() != 1) {
        allowed_.assign(1, range);
        restrict_faces();
        return;
    }
    Range& faces = faces_.front();  // the usual case
    faces.low = std::max(faces.low, range.low);
    faces.high = std::min(faces.high, range.high);
    if (!(faces.low <= faces.high)) faces_.clear();
}

// Finds the ranges between chains. Chains of one camera keep their order, because its outlines do
// not cross, and it carves every other gap between them. False if the order of chains is not
// certain.
bool StripChart::find_ranges_between_chains(const Bundle& bundle, bool carves_near) {
    const Node* const at_start = bundle.strip_nodes();  // sorted by `start_lines`
    const std::vector<Active>& chains = bundle.active;
    for (std::size_t i = 1; i < chains.size(); ++i) {
        if (!(low(at_start[i - 1].bounds) > high(at_start[i].bounds))) return false;
    }
    allowed_.clear();
    double above = kInfinity;
    bool is_carved = carves_near;
    for (const Active& chain : chains) {
        if (!is_carved) allowed_.push_back({low(chain.bounds), above});
        above = high(chain.bounds);
        is_carved = !is_carved;
    }
    if (!is_carved) allowed_.push_back({-kInfinity, above});
    return true;
}

// Returns the range of u of the pieces at which this camera begins or ends to carve.
StripChart::Range StripChart::carving_range(const Bundle& bundle) const {
    const Node* const nodes = bundle.strip_nodes();
    Bounds bounds = Bounds::Constant(kInfinity);
    for (std::uint32_t s = 0; s < bundle.num_spans; ++s) {
        const Span& span = bundle.spans[s];
        if (!carves(span.strip)) continue;
        bounds = bounds.min(nodes[span.from].bounds).min(nodes[span.to].bounds);
    }
    return {low(bounds), high(bounds)};
}

// Intersects `faces_` with `allowed_`. Both lists are sorted by falling u; ranges in `allowed_` may
// overlap.
void StripChart::restrict_faces() {
    less_faces_.clear();
    for (const Range& range : faces_) {
        for (const Range& other : allowed_) {
            const Range common{std::max(range.low, other.low), std::min(range.high, other.high)};
            if (!(common.low <= common.high)) continue;
            if (!less_faces_.empty() && common.high >= less_faces_.back().low) {
                Range& last = less_faces_.back();
                last.low = std::min(last.low, common.low);
                last.high = std::max(last.high, common.high);
            } else {
                less_faces_.push_back(common);
            }
        }
    }
    std::swap(faces_, less_faces_);
}

}  // namespace atrium::hull
