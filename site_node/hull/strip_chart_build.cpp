#include "site_node/hull/rounding.hpp"
#include "site_node/hull/strip_chart.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::hull {

// Builds the pieces that reach between the limits, with their events.
void StripChart::build() {
    std::size_t most_pieces = 1;
    std::size_t most_events = 0;
    for (const Bundle& bundle : bundles()) {
        most_pieces += bundle.num_spans;
        most_events += bundle.num_events;
    }
    if (pieces_.size() < most_pieces) {
        pieces_.resize(2 * most_pieces);
        visible_at_start_.resize(2 * most_pieces);
        seen_.resize(2 * most_pieces);
    }
    if (events_.size() < most_events) {
        events_.resize(2 * most_events);
        entries_.resize(2 * most_events);
        order_.resize(2 * most_events);
    }
    for (const Bundle& bundle : bundles()) {
        if (!find_visible(bundle)) continue;
        if (bundle.num_events > 0) build_events(bundle);
        build_pieces(bundle);
    }
}

// Returns true if each chain is wholly above or wholly below the limits. Then crosses those above.
bool StripChart::pass_chains(const Bundle& bundle) {
    unsigned num_above = 0;
    for (const Active& chain : bundle.active) {
        if (high(chain.bounds) < limits_.low) continue;
        if (!(low(chain.bounds) > limits_.high)) return false;
        ++num_above;
    }
    // where all carve, all strips of a camera toggle the same bit
    const Cones::Toggles carved{static_cast<std::uint8_t>(num_above & 1u)};
    verdict_above_ ^= carved.of(bundle.view);
    return true;
}

// Finds the visible spans and counts them at their nodes. False if there are none.
bool StripChart::find_visible(const Bundle& bundle) {
    const Bounds limits(limits_.high, -limits_.low);
    if (bundle.bounds.y() > limits.y()) return false;  // all are below
    if (all_carve_ && bundle.has_only_chains && pass_chains(bundle)) return false;
    const Node* const nodes = bundle.strip_nodes();
    const Span* const spans = bundle.spans.data();
    const std::uint32_t num_spans = bundle.num_spans;
    const std::uint32_t num_at_start = bundle.num_at_start;
    std::uint32_t* const seen = seen_.data();
    std::uint32_t num_seen = 0;
    const Cones::Toggles* const toggles = cones_->toggles.data();
    unsigned above = 0;
    for (std::uint32_t s = 0; s < num_spans; ++s) {  // no branch: unpredictable
        const Span& span = spans[s];
        const Bounds bounds = nodes[span.from].bounds.min(nodes[span.to].bounds);
        const unsigned is_above = bounds.x() > limits.x() ? 1 : 0;
        const unsigned is_below = bounds.y() > limits.y() ? 1 : 0;
        const unsigned is_at_start = span.from < num_at_start ? 1 : 0;
        above ^= (0u - (is_above & is_at_start)) & toggles[span.strip].bits;
        seen[num_seen] = s;
        num_seen += (is_above | is_below) ^ 1u;
    }
    verdict_above_ ^= Cones::Toggles{static_cast<std::uint8_t>(above)}.of(bundle.view);
    num_seen_ = num_seen;
    if (num_seen == 0) return false;
    const std::size_t num_nodes = bundle.first_end() + bundle.active.size();
    if (uses_.size() < num_nodes) uses_.resize(2 * num_nodes);
    NodeUse* const uses = uses_.data();
    std::fill_n(uses, num_nodes, NodeUse{});
    for (std::uint32_t i = 0; i < num_seen; ++i) {
        ++uses[spans[seen[i]].from].num_seen;
        ++uses[spans[seen[i]].to].num_seen;
    }
    return true;
}

void StripChart::build_events(const Bundle& bundle) {
    const Node* const nodes = bundle.strip_nodes();
    double last_phi = 0.0;
    double last_error = 0.0;
    for (std::uint32_t e = 0; e < bundle.num_events; ++e) {
        const std::uint32_t at = bundle.is_rising ? e : bundle.num_events - 1 - e;
        NodeUse& use = uses_[bundle.num_at_start + at];
        if (use.num_seen == 0) continue;
        const Node& node = nodes[bundle.num_at_start + at];
        std::uint32_t position = bundle.position + at;
        if (position >= bundle.num_rays) position -= bundle.num_rays;
        const PencilSide::InOrder& ray = bundle.other->in_order[position];
        // the order around the baseline is exact; phi must only not contradict it
        const double inverse = node.error;
        const double error = phi_error_scale_ * ray.length * inverse;
        if (error < 1.0) {
            const double phi = node.value * inverse;
            last_error = phi < last_phi ? std::max(error, last_error) : error;
            last_phi = std::clamp(phi, last_phi, 1.0);
        } else {
            last_error = 1.0;
        }
        use.event = num_events_;
        Event& event = events_[num_events_];
        event.phi = last_phi;
        event.phi_error = last_error;
        event.ray = bundle.first_ray + ray.local;
        event.view = static_cast<std::uint8_t>(bundle.view);
        const std::uint32_t num_strips =
            ray.through[0] != kNoStrip ? 2 : cones_->incidence[event.ray].count;
        event.is_wholly_visible = use.num_seen == num_strips;
        event.is_above_faces = low(node.bounds) > limits_.high;
        event.num_arriving = event.num_leaving = 0;
        entries_[num_events_] = {last_phi, last_error, num_events_, bundle.view};
        ++num_events_;
    }
}

void StripChart::build_pieces(const Bundle& bundle) {
    const Node* const nodes = bundle.strip_nodes();
    for (std::uint32_t i = 0; i < num_seen_; ++i) {
        const Span& span = bundle.spans[seen_[i]];
        const bool from_start = span.from < bundle.num_at_start;
        const bool to_end = span.to >= bundle.first_end();
        const Value at_from = from_start ? Value{nodes[span.from].value, nodes[span.from].error}
                                         : value_at(bundle, span.strip, own_.from);
        const Value at_to = to_end ? Value{nodes[span.to].value, nodes[span.to].error}
                                   : value_at(bundle, span.strip, own_.to);
        const std::uint32_t p = num_pieces_++;
        Piece& piece = pieces_[p];
        piece.at_from = at_from.u;
        piece.slope = at_to.u - at_from.u;
        piece.error = std::max(at_from.error, at_to.error) +
                      8.0 * kRounding * (std::abs(at_from.u) + std::abs(piece.slope));
        piece.strip = span.strip;
        piece.start_event = piece.end_event = kNone;
        piece.view = static_cast<std::uint8_t>(bundle.view);
        if (from_start) {
            visible_at_start_[num_visible_at_start_++] = p;
        } else {
            piece.start_event = uses_[span.from].event;
            Event& event = events_[piece.start_event];
            event.leaving[event.num_leaving++] = p;
        }
        if (to_end) continue;
        piece.end_event = uses_[span.to].event;
        Event& event = events_[piece.end_event];
        event.arriving[event.num_arriving++] = p;
        if (event.num_arriving > 1) order_arriving(event);
    }
}

// Adds the piece u = 0 over the whole strip.
void StripChart::build_infinity() {
    visible_at_start_[num_visible_at_start_++] = num_pieces_;
    Piece& infinity = pieces_[num_pieces_++] = {};
    infinity.strip = kInfinityStrip;
    infinity.view = static_cast<std::uint8_t>(view_);
}

// Sorts arriving pieces in the order of the strips at the ray: the first strip gives the vertex its
// position.
void StripChart::order_arriving(Event& event) const {
    const auto& strips = cones_->incidence[event.ray].strips;
    const auto place = [&](std::uint32_t p) {
        return std::find(strips.begin(), strips.end(), pieces_[p].strip) - strips.begin();
    };
    std::sort(event.arriving.begin(),
              event.arriving.begin() + event.num_arriving,
              [&](std::uint32_t l, std::uint32_t r) { return place(l) < place(r); });
}

}  // namespace atrium::hull
