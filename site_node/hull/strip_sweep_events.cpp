#include "site_node/hull/strip_sweep.hpp"

#include <Eigen/Geometry>

#include <algorithm>

namespace atrium::hull {

// Where the plane of `strip` cuts `ray` of this view: 1 / depth.
double StripSweep::u_at_ray(std::uint32_t ray, std::uint32_t strip) const {
    const std::uint32_t k = cones_->view_of[strip];
    const double inverse = pencils_->side(k, view_).inverse_offset[strip - cones_->views[k].first];
    return -cones_->normal[strip].dot(cones_->ray[ray]) * inverse;
}

// All lines at the first ray of a run, in order.
void StripSweep::start_lines(std::uint32_t ray) {
    lines_.clear();
    Line centre;
    centre.u_before = centre.u = centre.u0 = centre.u1 = std::numeric_limits<double>::infinity();
    centre.strip = kCentreStrip;
    centre.view = view_;
    lines_.push_back(centre);
    Line infinity;  // at depth infinity one leaves what exists: "outside of one's own cone"
    infinity.strip = kInfinityStrip;
    infinity.view = view_;
    lines_.push_back(infinity);
    const std::uint32_t local_ray = ray - cones_->views[view_].first;
    for (std::uint32_t k = 0; k < cones_->num_views(); ++k) {
        if (k == view_) continue;
        const PencilSide& other = pencils_->side(k, view_);
        const std::uint32_t rank = pencils_->side(view_, k).rank[local_ray];
        const std::uint32_t first = cones_->views[k].first;
        for (std::uint32_t g = first; g < cones_->views[k].last; ++g) {
            const auto [from, to] = other.end_positions[g - first];
            // the arc (from, to] of sorted positions holds the ray's rank, maybe across the end of
            // the circle
            const bool pierced =
                from < to ? (from < rank && rank <= to) : (from < rank || rank <= to);
            if (!pierced) continue;
            Line line;
            line.strip = g;
            line.view = k;
            line.u = u_at_ray(ray, g);
            lines_.push_back(line);
        }
    }
    std::sort(lines_.begin() + 1, lines_.end(), [](const Line& l, const Line& r) {
        return l.u != r.u ? l.u > r.u : l.strip < r.strip;
    });
    std::uint64_t inside = cones_->views_around_centre(view_);
    lines_[0].inside_below = inside;
    for (std::size_t p = 1; p < lines_.size(); ++p) {
        inside ^= std::uint64_t{1} << lines_[p].view;
        lines_[p].inside_below = inside;
    }
}

void StripSweep::collect_events(std::uint32_t strip) {
    events_.clear();
    ranges_.resize(cones_->num_views());
    for (std::uint32_t k = 0; k < cones_->num_views(); ++k) {
        if (k != view_) collect_events_of(strip, k);
    }
}

void StripSweep::collect_events_of(std::uint32_t strip, std::uint32_t k) {
    const PencilSide& own = pencils_->side(view_, k);
    const PencilSide& other = pencils_->side(k, view_);
    const std::uint32_t first = cones_->views[view_].first;
    const std::uint32_t g0 = strip - first;
    const std::uint32_t g1 = cones_->next[strip] - first;
    const auto n = static_cast<std::uint32_t>(other.sorted.size());
    const bool rising = own.rises[g0];
    const std::uint32_t from = own.rank[g0];
    const std::uint32_t to = own.rank[g1];
    EventRange& range = ranges_[k];
    range.first = static_cast<std::uint32_t>(events_.size());
    range.rising = rising;
    // the ranks alone do not tell no ray from all rays: the arc may cross the end of the circle
    const bool wraps = (own.position[g1] < own.position[g0]) == rising;
    range.count = (rising ? to - from : from - to) + (wraps ? n : 0);
    range.first_position = rising ? from : from + n - 1;
    if (range.first_position >= n) range.first_position -= n;

    const Eigen::Vector2d& a0 = own.across[g0];
    const Eigen::Vector2d& a1 = own.across[g1];
    const Eigen::Vector3d& normal = cones_->normal[strip];
    const Cones::View& view = cones_->views[view_];
    const double baseline_depth = view.axis.dot(cones_->views[k].centre - view.centre);
    double last_phi = 0.0;
    std::uint32_t position = range.first_position;
    for (std::uint32_t e = 0; e < range.count; ++e) {
        const std::uint32_t local = other.sorted[position];
        const Eigen::Vector2d& am = other.across[local];
        const Eigen::Vector3d& ray = cones_->ray[cones_->views[k].first + local];
        const double e0 = std::abs(am.x() * a0.y() - am.y() * a0.x());
        const double e1 = std::abs(am.x() * a1.y() - am.y() * a1.x());
        // the order around the baseline is what counts; phi only has to follow it
        last_phi = std::clamp(e0 + e1 > 0.0 ? e0 / (e0 + e1) : last_phi, last_phi, 1.0);
        const double g = normal.dot(ray);
        const double u = g / (g * baseline_depth - own.offset[g0] * view.axis.dot(ray));
        events_.push_back({last_phi, u, cones_->views[k].first + local, k, rising});
        position = rising ? (position + 1 == n ? 0 : position + 1)
                          : (position == 0 ? n - 1 : position - 1);
    }
}

// Sets where the line ends in this strip, given where it begins. Needs the events in collected
// order.
void StripSweep::aim(Line& line) {
    const std::uint32_t k = line.view;
    const EventRange& range = ranges_[k];
    const PencilSide& other = pencils_->side(k, view_);
    const std::uint32_t first = cones_->views[k].first;
    const auto n = static_cast<std::uint32_t>(other.sorted.size());
    const std::uint32_t position = other.end_positions[line.strip - first][range.rising ? 1 : 0];
    std::uint32_t steps =
        range.rising ? position + n - range.first_position : range.first_position + n - position;
    if (steps >= n) steps -= n;
    if (steps < range.count) {
        const Event& event = events_[range.first + steps];
        line.phi1 = event.phi;
        line.u1 = event.u;
    } else {
        line.phi1 = 1.0;
        line.u1 = u_at_ray(cones_->next[strip_], line.strip);
    }
    line.slope = line.phi1 > line.phi0 ? (line.u1 - line.u0) / (line.phi1 - line.phi0) : 0.0;
}

}  // namespace atrium::hull
