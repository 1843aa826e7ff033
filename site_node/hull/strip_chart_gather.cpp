#include "site_node/hull/rounding.hpp"
#include "site_node/hull/sort_few.hpp"
#include "site_node/hull/strip_chart.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::hull {
namespace {

// Error of phi above which the error of u in an event has no bound.
constexpr double kRoughPhi = 0.25;

}  // namespace

// Finds where the lines of all cameras end or bend, and moves the active lines on to the strip's
// second ray. Each step runs over all cameras, because each camera has only a few lines and events.
bool StripChart::gather() {
    find_events();
    if (num_steps_ > max_steps_) return true;
    start_lines();
    bound_events();
    if (!pass_events()) return false;
    end_lines();
    return true;
}

// Finds the rays of each camera that pierce the strip.
void StripChart::find_events() {
    const Cones::View& own_view = cones_->views[view_];
    const std::uint32_t from_ray = own_.from - own_view.first_ray;
    const std::uint32_t to_ray = own_.to - own_view.first_ray;
    const std::uint32_t strip = strip_ - own_view.first_strip;
    for (Bundle& bundle : bundles()) {
        bundle.first += bundle.first_end();  // skip to the nodes on the ray that both strips share
        bundle.num_at_start = static_cast<std::uint32_t>(bundle.active.size());
        bundle.num_events = 0;
        if (bundle.num_rays == 0) continue;
        const PencilSide& own = *bundle.own;
        const bool is_rising = own.rises[strip] != 0;
        const std::uint32_t from = own.rank[from_ray];
        const std::uint32_t to = own.rank[to_ray];
        // equal ranks mean no ray or all rays: positions tell whether the arc wraps around
        const bool wraps = (own.position[to_ray] < own.position[from_ray]) == is_rising;
        const std::uint32_t least = is_rising ? from : to;
        const std::uint32_t least_position = least == bundle.num_rays ? 0 : least;
        // needed soon; each camera has separate lists, and each strip reads few entries of them
        __builtin_prefetch(&own.across[to_ray]);
        const PencilSide::InOrder* const rays = &bundle.other->in_order[least_position];
        for (std::size_t i = 0; i <= PencilSide::kSpareRays; ++i) __builtin_prefetch(rays + i);
        bundle.is_rising = is_rising;
        bundle.position = least_position;
        bundle.num_events = (is_rising ? to - from : from - to) + (wraps ? bundle.num_rays : 0);
        num_steps_ += 2 * (std::uint64_t{bundle.num_at_start} + bundle.num_events);
    }
}

// Starts the lines at the strip's first ray. Their nodes are those at the end of the previous
// strip.
void StripChart::start_lines() {
    for (Bundle& bundle : bundles()) {
        const std::uint32_t num_active = bundle.num_at_start;
        // up to three lines begin in an event; `bound_events` writes at least four events, two at a
        // time
        const std::uint32_t most_nodes = 2 * num_active + 4 * bundle.num_events + 4;
        const std::uint32_t most_spans = num_active + 3 * bundle.num_events;
        if (bundle.first + most_nodes > bundle.room_for_nodes || most_spans > bundle.room_for_spans)
            make_room(bundle, most_nodes, most_spans);
        bundle.num_spans = 0;
        bundle.has_only_chains = true;
        bundle.bounds = bundle.at_ray;
        const Node* const nodes = bundle.strip_nodes();
        for (std::uint32_t i = 2; i < num_active; ++i) {
            if (nodes[i - 2].value > nodes[i - 1].value && nodes[i - 1].value > nodes[i].value)
                continue;
            sort_lines(bundle);
            break;
        }
        Active* const active = bundle.active.data();
        for (std::uint32_t i = 0; i < num_active; ++i) {
            active[i].bounds = nodes[i].bounds;
            active[i].from = i;
        }
    }
}

void StripChart::make_room(Bundle& bundle, std::uint32_t num_nodes, std::uint32_t num_spans) {
    std::copy_n(bundle.strip_nodes(), bundle.num_at_start, bundle.nodes.begin());
    bundle.first = 0;
    if (num_nodes > bundle.room_for_nodes) bundle.nodes.resize(4 * std::size_t{num_nodes});
    if (num_spans > bundle.room_for_spans) bundle.spans.resize(2 * std::size_t{num_spans});
    bundle.room_for_nodes = static_cast<std::uint32_t>(bundle.nodes.size());
    bundle.room_for_spans = static_cast<std::uint32_t>(bundle.spans.size());
}

// Sorts lines by falling u. Chains keep their order from strip to strip, so this is rarely needed.
void StripChart::sort_lines(Bundle& bundle) {
    Node* const nodes = bundle.strip_nodes();
    lines_.clear();
    for (std::uint32_t i = 0; i < bundle.num_at_start; ++i)
        lines_.emplace_back(nodes[i], bundle.active[i].strip);
    const std::span<std::pair<Node, std::uint32_t>> lines(lines_);
    sort_few(lines, [](const auto& l, const auto& r) { return l.first.value > r.first.value; });
    for (std::uint32_t i = 0; i < bundle.num_at_start; ++i) {
        nodes[i] = lines[i].first;
        bundle.active[i].strip = lines[i].second;
        place_of_[lines[i].second] = i;
    }
}

// Bounds u in the events, the rays of other cameras that pierce this strip.
//
// Such a ray and the point of the strip that it pierces lie in one half-plane of the pencil. Let
// w_from and w_to be the cross products of the ray with the strip's two rays, across the baseline
// b. Then phi = w_to / (w_from + w_to) and, up to its sign, u = (normal . ray) / (|b| (w_from +
// w_to)).
void StripChart::bound_events() {
    using Two = Eigen::Array2d;  // values of two neighbouring events
    const std::uint32_t from_ray = own_.from - cones_->views[view_].first_ray;
    const std::uint32_t to_ray = own_.to - cones_->views[view_].first_ray;
    const Eigen::Vector3d normal = cones_->normal[strip_];
    const double error_scale = phi_error_scale_;
    for (Bundle& bundle : bundles()) {
        const PencilSide& own = *bundle.own;
        const Eigen::Vector2d a0 = own.across[from_ray];
        const Eigen::Vector2d a1 = own.across[to_ray];
        // the sign tells on which side of the strip's plane the other centre lies
        const double scale = bundle.is_rising == (view_ < bundle.view) ? own.inverse_baseline
                                                                       : -own.inverse_baseline;
        const double u_spread = spread_scale_ * own.inverse_baseline;  // see docs/design/hull.md
        std::uint32_t position = bundle.position;
        Node* node = bundle.strip_nodes() + bundle.num_at_start;
        for (std::uint32_t left = bundle.num_events; left > 0; position = 0) {
            const std::uint32_t count = std::min(left, bundle.num_rays - position);
            const PencilSide::InOrder* const rays = bundle.other->in_order.data() + position;
            Two largest_error = Two::Zero();
            const auto bound_two = [&](std::uint32_t i) {
                const PencilSide::InOrder& first = rays[i];
                const PencilSide::InOrder& second = rays[i + 1];
                const Two x(first.across_x, second.across_x);
                const Two y(first.across_y, second.across_y);
                const Two w_to = (x * a0.y() - y * a0.x()).abs();
                const Two w_from = (x * a1.y() - y * a1.x()).abs();
                const Two inverse = (w_from + w_to).inverse();
                const Two error = error_scale * Two(first.length, second.length) * inverse;
                const Two n_ray = normal.x() * Two(first.x, second.x) +
                                  normal.y() * Two(first.y, second.y) +
                                  normal.z() * Two(first.z, second.z);
                const Two u = scale * (n_ray * inverse);
                const Two u_error = 2.0 * error * (u.abs() + u_spread);
                const Two low = u - u_error;
                const Two minus_high = -u_error - u;
                largest_error = largest_error.max(error);
                node[i] = {{low.x(), minus_high.x()}, w_to.x(), inverse.x()};
                node[i + 1] = {{low.y(), minus_high.y()}, w_to.y(), inverse.y()};
            };
            // usually at most four; how many is unpredictable
            bound_two(0);
            bound_two(2);
            for (std::uint32_t i = 4; i < count; i += 2) bound_two(i);
            if (!(largest_error.maxCoeff() < kRoughPhi)) {
                for (std::uint32_t i = 0; i < count; ++i) {
                    if (error_scale * rays[i].length * node[i].error < kRoughPhi) continue;
                    node[i].bounds.setConstant(-kInfinity);
                }
            }
            node += count;
            left -= count;
        }
    }
}

// Ends and begins spans in the rays of other cameras. False if the pencils contradict each other.
bool StripChart::pass_events() {
    std::uint32_t* const place_of = place_of_.data();
    const Eigen::Vector3d* const normals = cones_->normal.data();
    for (Bundle& bundle : bundles()) {
        const PencilSide::InOrder* const rays = bundle.other->in_order.data();
        const PencilSide::Offset* const offsets = bundle.other->offset.data();
        const Node* const nodes = bundle.strip_nodes();
        Active* active = bundle.active.data();
        auto num_active = static_cast<std::uint32_t>(bundle.active.size());
        Span* span = bundle.spans.data();
        const std::size_t ending = bundle.is_rising ? 0 : 1;
        const std::uint32_t step = bundle.is_rising ? 1 : ~std::uint32_t{0};
        const std::uint32_t n = bundle.num_rays;
        const std::uint32_t to_last = bundle.is_rising ? 0 : bundle.num_events - 1;
        std::uint32_t node = bundle.num_at_start + to_last;
        std::uint32_t position = bundle.position + to_last;
        if (position >= n) position -= n;
        Bounds bounds = bundle.bounds;
        for (std::uint32_t left = bundle.num_events; left > 0; --left, node += step) {
            const Bounds& at = nodes[node].bounds;
            bounds = bounds.min(at);
            const std::uint32_t ends = rays[position].through[ending];
            if (ends != kNoStrip) {
                // the usual event: one line continues as another
                const std::uint32_t begins = rays[position].through[1 - ending];
                const std::uint32_t place = place_of[ends];
                if (place >= num_active) return false;
                Active& line = active[place];
                if (line.strip != ends) return false;
                line.bounds = line.bounds.min(at);
                *span++ = {ends, line.from, node};
                line.strip = begins;
                line.from = node;
                place_of[begins] = place;
                // for `end_lines`
                __builtin_prefetch(&normals[begins]);
                __builtin_prefetch(&offsets[begins - bundle.first_strip]);
            } else {
                bundle.num_spans = static_cast<std::uint32_t>(span - bundle.spans.data());
                if (!pass_event(bundle, node, position)) return false;
                span = bundle.spans.data() + bundle.num_spans;
                active = bundle.active.data();
                num_active = static_cast<std::uint32_t>(bundle.active.size());
            }
            position += step;
            if (position >= n) position = bundle.is_rising ? 0 : n - 1;
        }
        bundle.num_spans = static_cast<std::uint32_t>(span - bundle.spans.data());
        bundle.bounds = bounds;
    }
    return true;
}

// Passes any other event: ends the lines of strips that end in its ray and begins the others, as
// seen along this strip.
bool StripChart::pass_event(Bundle& bundle, std::uint32_t node, std::uint32_t position) {
    bundle.has_only_chains = false;
    const std::uint32_t local = bundle.other->sorted[position];
    const Cones::Incidence& incidence = cones_->incidence[bundle.first_ray + local];
    if (incidence.count > incidence.strips.size()) return false;
    const std::uint32_t upper_ends = bundle.other->is_upper_end[local];
    const std::uint32_t arriving = bundle.is_rising ? upper_ends : ~upper_ends;
    std::vector<Active>& active = bundle.active;
    for (std::uint32_t j = 0; j < incidence.count; ++j) {
        if ((arriving >> j & 1) == 0) continue;
        const std::uint32_t strip = incidence.strips[j];
        const std::uint32_t place = place_of_[strip];
        if (place >= active.size() || active[place].strip != strip) return false;
        bundle.spans[bundle.num_spans++] = {strip, active[place].from, node};
        active[place] = active.back();
        place_of_[active[place].strip] = place;
        active.pop_back();
    }
    for (std::uint32_t j = 0; j < incidence.count; ++j) {
        if ((arriving >> j & 1) != 0) continue;
        const std::uint32_t strip = incidence.strips[j];
        place_of_[strip] = static_cast<std::uint32_t>(active.size());
        active.push_back({bundle.bounds, strip, node});
    }
    return true;
}

// Ends all spans on the strip's second ray.
void StripChart::end_lines() {
    const Eigen::Vector3d* const normals = cones_->normal.data();
    const Eigen::Vector3d ray = cones_->ray[own_.to];
    const double ray_length = cones_->ray_length[own_.to];
    for (Bundle& bundle : bundles()) {
        const PencilSide::Offset* const offsets = bundle.other->offset.data();
        std::uint32_t node = bundle.first_end();
        Node* const nodes = bundle.strip_nodes();
        Span* span = bundle.spans.data() + bundle.num_spans;
        Bounds at_ray = Bounds::Constant(kInfinity);
        for (Active& line : bundle.active) {
            const std::uint32_t strip = line.strip;
            const Node end = node_of(
                value_of(offsets[strip - bundle.first_strip], normals[strip], ray, ray_length));
            nodes[node] = end;
            line.bounds = line.bounds.min(end.bounds);
            at_ray = at_ray.min(end.bounds);
            *span++ = {strip, line.from, node++};
        }
        bundle.at_ray = at_ray;
        bundle.bounds = bundle.bounds.min(at_ray);
        bundle.num_spans += static_cast<std::uint32_t>(bundle.active.size());
    }
}

}  // namespace atrium::hull
