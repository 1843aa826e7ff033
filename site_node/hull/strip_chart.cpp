#include "site_node/hull/strip_chart.hpp"

#include "site_node/hull/rounding.hpp"
#include "site_node/hull/sort_few.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::hull {

void StripChart::start(const Cones& cones,
                       const Pencils& pencils,
                       std::uint32_t strip,
                       std::uint64_t max_steps) {
    cones_ = &cones;
    pencils_ = &pencils;
    view_ = cones.strips[strip].view;
    infinity_toggles_ = {std::uint64_t{1} << view_, 0};
    is_degenerate_ = false;
    all_carve_ = cones.min_seen == 0;
    num_steps_ = 0;
    max_steps_ = max_steps;
    if (place_of_.size() < cones.strips.size()) place_of_.resize(cones.strips.size());
    find_active(cones.strips[strip].from);
    go_on(strip);
}

void StripChart::go_on(std::uint32_t strip) {
    strip_ = strip;
    own_ = cones_->strips[strip];
    phi_error_scale_ =
        64.0 * kRounding * std::max(cones_->ray_length[own_.from], cones_->ray_length[own_.to]);
    spread_scale_ = 16.0 * kRounding * cones_->normal_bound[strip_] / phi_error_scale_;
}

// Finds the lines that meet `ray`, and the verdict at this camera's centre.
void StripChart::find_active(std::uint32_t ray) {
    const std::uint32_t local_ray = ray - cones_->views[view_].first_ray;
    verdict_at_centre_ = {};
    num_bundles_ = 0;
    if (bundles_.size() < cones_->num_views()) bundles_.resize(cones_->num_views());
    for (std::uint32_t k = 0; k < cones_->num_views(); ++k) {
        if (k == view_) continue;
        const Cones::View& view = cones_->views[k];
        Bundle& bundle = bundles_[num_bundles_++];
        bundle.own = &pencils_->side(view_, k);
        bundle.other = &pencils_->side(k, view_);
        bundle.view = k;
        bundle.first_ray = view.first_ray;
        bundle.first_strip = view.first_strip;
        bundle.num_rays = view.last_ray - view.first_ray;
        bundle.active.clear();
        bundle.first = bundle.num_at_start = bundle.num_events = 0;
        bundle.at_ray.setConstant(kInfinity);
        const std::uint32_t rank = bundle.own->rank[local_ray];
        const auto* const ends = bundle.other->end_positions.data();
        Verdict crossed;
        for (std::uint32_t s = 0; s < view.last_strip - view.first_strip; ++s) {
            const auto [from, to] = ends[s];
            // the arc (from, to] of sorted positions contains the rank of the ray; it may wrap
            // around
            const unsigned is_after = from < rank ? 1 : 0;
            const unsigned is_before = rank <= to ? 1 : 0;
            const unsigned wraps = from < to ? 0 : 1;
            if (((is_after & is_before) | ((is_after | is_before) & wraps)) == 0) continue;
            const std::uint32_t strip = view.first_strip + s;
            const auto place = static_cast<std::uint32_t>(bundle.active.size());
            const Node node = node_of(value_at(bundle, strip, ray));
            if (bundle.nodes.size() <= place) bundle.nodes.resize(2 * place + 16);
            bundle.nodes[place] = node;
            bundle.at_ray = bundle.at_ray.min(node.bounds);
            place_of_[strip] = place;
            bundle.active.push_back({node.bounds, strip, 0});
            crossed ^= cones_->toggles[strip].of(k);
        }
        num_steps_ += (view.last_strip - view.first_strip) / 16;
        // Seen from the other camera, the half-plane of `ray` spans the directions from one end of
        // the baseline to the other. One end points behind that camera, where it sees nothing. All
        // its strips that meet the half-plane lie between the two ends.
        verdict_at_centre_ ^= cones_->verdict_beyond(k);
        if (view.axis.dot(cones_->views[view_].centre - view.centre) > 0.0)
            verdict_at_centre_ ^= crossed;
    }
}

bool StripChart::collect() {
    num_pieces_ = num_events_ = num_visible_at_start_ = 0;
    if (!gather()) return false;
    if (num_steps_ > max_steps_) return true;
    find_limits();
    // faces end at u = 0, infinity
    const bool may_reach_infinity = limits_.low <= 0.0;
    limits_.low = std::max(limits_.low, 0.0);
    if (!may_have_faces()) return true;
    verdict_above_ = verdict_at_centre_;
    build();
    if (may_reach_infinity) build_infinity();
    sort_events();
    return true;
}

void StripChart::sort_events() {
    num_steps_ += num_events_;
    const auto before = [this](const Entry& l, const Entry& r) { return is_before(l, r); };
    const std::span<Entry> entries(entries_.data(), num_events_);
    // the events of each camera are in order already: for a few, insertion is the fastest merge
    constexpr std::uint32_t kFew = 32;
    if (num_events_ <= kFew) {
        sort_few(entries, before);
    } else {
        merge_events(before);
    }
    for (std::uint32_t i = 0; i < num_events_; ++i) order_[i] = entries_[i].event;
}

// Merges the lists of neighbouring cameras pairwise until one list is left.
template <typename Before>
void StripChart::merge_events(const Before& before) {
    list_ends_.clear();
    for (std::uint32_t i = 1; i < num_events_; ++i) {
        if (entries_[i].view != entries_[i - 1].view) list_ends_.push_back(i);
    }
    list_ends_.push_back(num_events_);
    if (merged_.size() < entries_.size()) merged_.resize(entries_.size());
    while (list_ends_.size() > 1) {
        std::size_t num_lists = 0;
        std::uint32_t begin = 0;
        for (std::size_t l = 0; l < list_ends_.size(); l += 2) {
            const std::uint32_t middle = list_ends_[l];
            const std::uint32_t end = l + 1 < list_ends_.size() ? list_ends_[l + 1] : middle;
            const Entry* const entries = entries_.data();
            std::merge(entries + begin,
                       entries + middle,
                       entries + middle,
                       entries + end,
                       merged_.data() + begin,
                       before);
            list_ends_[num_lists++] = begin = end;
        }
        list_ends_.resize(num_lists);
        std::swap(entries_, merged_);
    }
}

}  // namespace atrium::hull
