#include "site_node/hull/strip_chart.hpp"

#include "site_node/hull/rounding.hpp"
#include "site_node/hull/sort_few.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::hull {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

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
    if (active_.size() < cones.num_views()) active_.resize(cones.num_views());
    find_active(cones.strips[strip].from);
    go_on(strip);
}

void StripChart::go_on(std::uint32_t strip) {
    strip_ = strip;
    own_ = cones_->strips[strip];
    phi_error_scale_ =
        64.0 * kRounding * std::max(cones_->ray_length[own_.from], cones_->ray_length[own_.to]);
}

// The lines that meet `ray`, and what the cameras say about this camera's own place.
void StripChart::find_active(std::uint32_t ray) {
    const std::uint32_t local_ray = ray - cones_->views[view_].first_ray;
    verdict_at_centre_ = {};
    for (std::uint32_t k = 0; k < cones_->num_views(); ++k) {
        active_[k].clear();
        if (k == view_) continue;
        const Cones::View& view = cones_->views[k];
        other_first_strip_ = view.first_strip;
        const PencilSide& other = pencils_->side(k, view_);
        const std::uint32_t rank = pencils_->side(view_, k).rank[local_ray];
        Verdict crossed;
        for (std::uint32_t s = 0; s < view.last_strip - view.first_strip; ++s) {
            const auto [from, to] = other.end_positions[s];
            // the arc (from, to] of sorted positions holds the ray's rank, maybe across the end of
            // the circle
            const bool is_pierced =
                from < to ? (from < rank && rank <= to) : (from < rank || rank <= to);
            if (!is_pierced) continue;
            const std::uint32_t strip = view.first_strip + s;
            const Value value = value_at(other, strip, ray);
            active_[k].push_back({strip, value.u, value.error, 0});
            crossed ^= cones_->strips[strip].toggles;
        }
        num_steps_ += (view.last_strip - view.first_strip) / 16;
        // Of the two ways along the baseline one is behind the other camera, where it sees nothing.
        // All its strips that meet the half-plane of `ray` are between the two ways.
        verdict_at_centre_ ^= cones_->verdict_beyond(k);
        if (view.axis.dot(cones_->views[view_].centre - view.centre) > 0.0)
            verdict_at_centre_ ^= crossed;
    }
}

// Where the plane of `strip` cuts a ray of this view: 1 / depth.
StripChart::Value StripChart::value_at(const PencilSide& other,
                                       std::uint32_t strip,
                                       std::uint32_t ray) const {
    const PencilSide::Offset& offset = other.offset[strip - other_first_strip_];
    const double u = -cones_->normal[strip].dot(cones_->ray[ray]) * offset.inverse;
    const double error = offset.dot_error * cones_->ray_length[ray] + std::abs(u) * offset.error;
    return {u, error * offset.certain};
}

void StripChart::open_piece(const PencilSide& other, Active& active, const Place& at) {
    const Value at_to = value_at(other, active.strip, own_.to);
    Piece& piece = pieces_.emplace_back();
    piece.strip = active.strip;
    piece.view = static_cast<std::uint8_t>(other_view_);
    piece.at_from = active.u;
    piece.slope = at_to.u - active.u;
    piece.error = std::max(active.error, at_to.error) +
                  8.0 * kRounding * (std::abs(active.u) + std::abs(piece.slope));
    piece.start_event = at.event;
    const double start = piece.at_from + at.phi * piece.slope;
    const double margin = piece.error + std::abs(piece.slope) * at.phi_error;
    piece.min_u = start - margin;
    piece.max_u = start + margin;
    active.piece = static_cast<std::uint32_t>(pieces_.size()) - 1;
    active.u = at_to.u;  // for the next strip
    active.error = at_to.error;
}

// Of a line that does not come from the strip's first ray.
void StripChart::begin_piece(const PencilSide& other, Active& active, const Place& at) {
    const Value at_from = value_at(other, active.strip, own_.from);
    active.u = at_from.u;
    active.error = at_from.error;
    open_piece(other, active, at);
}

void StripChart::close_piece(std::uint32_t p, const Place& at) {
    Piece& piece = pieces_[p];
    piece.end_event = at.event;
    const double end = piece.at_from + at.phi * piece.slope;
    const double margin = piece.error + std::abs(piece.slope) * at.phi_error;
    piece.min_u = std::min(piece.min_u, end - margin);
    piece.max_u = std::max(piece.max_u, end + margin);
    if (!carves(piece.strip)) return;
    nearest_ = std::max(nearest_, piece.max_u);
    farthest_ = std::min(farthest_, piece.min_u);
}

bool StripChart::collect() {
    pieces_.clear();
    events_.clear();
    order_.clear();
    highest_ = kInfinity;
    lowest_ = -kInfinity;
    for (std::uint32_t k = 0; k < cones_->num_views(); ++k) {
        if (k != view_ && !collect_from(k)) return false;
        if (num_steps_ > max_steps_) return true;
    }
    // faces end at infinity, u = 0
    const bool may_reach_infinity = lowest_ <= 0.0;
    lowest_ = std::max(lowest_, 0.0);
    if (!may_have_faces()) return true;
    hide_pieces();
    if (may_reach_infinity) {
        visible_at_start_.push_back(static_cast<std::uint32_t>(pieces_.size()));
        Piece& infinity = pieces_.emplace_back();  // u = 0 all along
        infinity.strip = kInfinityStrip;
        infinity.view = static_cast<std::uint8_t>(view_);
    }
    sort_events();
    return true;
}

// Pieces and events of camera k, and where it leaves room for faces.
bool StripChart::collect_from(std::uint32_t k) {
    other_view_ = k;
    const PencilSide& own = pencils_->side(view_, k);
    const PencilSide& other = pencils_->side(k, view_);
    other_first_strip_ = cones_->views[k].first_strip;
    const bool carves_near = (verdict_at_centre_.carved >> k & 1) != 0;
    bool carves_far = carves_near;
    nearest_ = -kInfinity;
    farthest_ = kInfinity;
    for (Active& active : active_[k]) {
        if (carves(active.strip)) carves_far = !carves_far;
        open_piece(other, active, kStart);
    }
    num_steps_ += 2 * active_[k].size();
    if (!collect_events(own, other)) return false;
    for (const Active& active : active_[k]) close_piece(active.piece, kEnd);
    if (carves_near) highest_ = std::min(highest_, nearest_);
    if (carves_far) lowest_ = std::max(lowest_, farthest_);
    return true;
}

// The rays of the other camera that pierce this strip, along it.
bool StripChart::collect_events(const PencilSide& own, const PencilSide& other) {
    const Cones::View& view = cones_->views[view_];
    const std::uint32_t from_ray = own_.from - view.first_ray;
    const std::uint32_t to_ray = own_.to - view.first_ray;
    const auto n = static_cast<std::uint32_t>(other.sorted.size());
    if (n == 0) return true;
    const bool rising = own.rises[strip_ - view.first_strip] != 0;
    const std::uint32_t from = own.rank[from_ray];
    const std::uint32_t to = own.rank[to_ray];
    // the ranks alone do not tell no ray from all rays: the arc may cross the end of the circle
    const bool wraps = (own.position[to_ray] < own.position[from_ray]) == rising;
    const std::uint32_t count = (rising ? to - from : from - to) + (wraps ? n : 0);
    std::uint32_t position = rising ? from : from + n - 1;
    if (position >= n) position -= n;
    const Eigen::Vector2d& a0 = own.across[from_ray];
    const Eigen::Vector2d& a1 = own.across[to_ray];
    Place last = kStart;
    for (std::uint32_t e = 0; e < count; ++e) {
        const std::uint32_t local = other.sorted[position];
        const std::uint32_t ray = cones_->views[other_view_].first_ray + local;
        const Eigen::Vector2d& across = other.across[local];
        const double w_to = std::abs(across.x() * a0.y() - across.y() * a0.x());
        const double w_from = std::abs(across.x() * a1.y() - across.y() * a1.x());
        const double error = phi_error_scale_ * cones_->ray_length[ray];
        const double inverse = 1.0 / (w_from + w_to);
        // the order around the baseline is what counts; phi only has to follow it
        const double phi = w_to * inverse;
        Place at{last.phi, 1.0, static_cast<std::uint32_t>(events_.size())};
        if (error * inverse < 1.0) {
            at.phi = std::clamp(phi, last.phi, 1.0);
            at.phi_error =
                phi < last.phi ? std::max(error * inverse, last.phi_error) : error * inverse;
        }
        last = at;
        if (!add_event(other, ray, at, rising)) return false;
        if (num_steps_ > max_steps_) return true;
        position = rising ? (position + 1 == n ? 0 : position + 1)
                          : (position == 0 ? n - 1 : position - 1);
    }
    return true;
}

std::vector<StripChart::Active>::iterator StripChart::find(std::vector<Active>& active,
                                                           std::uint32_t strip) {
    const auto found = std::find_if(
        active.begin(), active.end(), [strip](const Active& a) { return a.strip == strip; });
    num_steps_ += 1 + static_cast<std::uint64_t>(found - active.begin()) / 8;
    return found;
}

// The strips that meet in `ray` end or begin here, seen along this strip.
bool StripChart::add_event(const PencilSide& other,
                           std::uint32_t ray,
                           const Place& at,
                           bool rising) {
    const Cones::Incidence& incidence = cones_->incidence[ray];
    if (incidence.count > incidence.strips.size()) return false;
    const std::uint32_t upper_ends = other.is_upper_end[ray - cones_->views[other_view_].first_ray];
    const std::uint32_t arriving = rising ? upper_ends : ~upper_ends;
    std::vector<Active>& active = active_[other_view_];
    Event& event = events_.emplace_back();
    event.phi = at.phi;
    event.phi_error = at.phi_error;
    event.ray = ray;
    event.view = static_cast<std::uint8_t>(other_view_);
    if (incidence.count == 2 && (arriving & 3) != 0 && (arriving & 3) != 3) {
        // the usual event: one line goes on as another
        const std::uint32_t ends = incidence.strips[(arriving & 1) != 0 ? 0 : 1];
        const auto found = find(active, ends);
        if (found == active.end()) return false;
        close_piece(found->piece, at);
        event.arriving[event.num_arriving++] = found->piece;
        found->strip = incidence.strips[(arriving & 1) != 0 ? 1 : 0];
        begin_piece(other, *found, at);
        event.leaving[event.num_leaving++] = found->piece;
        return true;
    }
    std::array<std::uint32_t, 3> leaving{};
    for (std::uint32_t j = 0; j < incidence.count; ++j) {
        const std::uint32_t strip = incidence.strips[j];
        if ((arriving >> j & 1) == 0) {
            leaving[event.num_leaving++] = strip;
            continue;
        }
        const auto found = find(active, strip);
        if (found == active.end()) return false;
        close_piece(found->piece, at);
        event.arriving[event.num_arriving++] = found->piece;
        *found = active.back();
        active.pop_back();
    }
    for (std::uint32_t j = 0; j < event.num_leaving; ++j) {
        active.push_back({leaving[j], 0.0, 0.0, 0});
        begin_piece(other, active.back(), at);
        event.leaving[j] = active.back().piece;
    }
    return true;
}

// No branch that depends on where a piece is: that cannot be foreseen, and there are many.
void StripChart::hide_pieces() {
    verdict_above_ = verdict_at_centre_;
    const std::size_t num_events = events_.size();
    const auto nowhere = static_cast<std::uint32_t>(num_events);
    num_visible_.assign(num_events + 1, 0);
    visible_at_start_.resize(pieces_.size());
    std::size_t num_at_start = 0;
    for (std::uint32_t p = 0; p < pieces_.size(); ++p) {
        Piece& piece = pieces_[p];
        const bool is_above = piece.min_u > highest_;
        const bool is_below = piece.max_u < lowest_;
        const bool is_visible = !(is_above | is_below);
        const bool is_at_start = piece.start_event == kNone;
        piece.visibility = static_cast<Visibility>((is_above ? 1 : 0) | (is_below ? 2 : 0));
        num_visible_[std::min(piece.start_event, nowhere)] += is_visible ? 1 : 0;
        num_visible_[std::min(piece.end_event, nowhere)] += is_visible ? 1 : 0;
        visible_at_start_[num_at_start] = p;
        num_at_start += (is_visible & is_at_start) ? 1 : 0;
        verdict_above_.carved ^= static_cast<std::uint64_t>(is_above & is_at_start) << piece.view;
    }
    visible_at_start_.resize(num_at_start);
    if (!all_carve_) judge_above();
    order_.resize(num_events);
    std::size_t num_in_order = 0;
    for (std::uint32_t e = 0; e < num_events; ++e) {
        Event& event = events_[e];
        order_[num_in_order] = e;
        num_in_order += num_visible_[e] != 0 ? 1 : 0;
        event.is_wholly_visible = num_visible_[e] == event.num_arriving + event.num_leaving;
    }
    order_.resize(num_in_order);
}

// The verdict above the visible pieces, where not every piece carves.
void StripChart::judge_above() {
    verdict_above_ = verdict_at_centre_;
    for (const Piece& piece : pieces_) {
        if (piece.visibility == Visibility::kAbove && piece.start_event == kNone)
            verdict_above_ ^= cones_->strips[piece.strip].toggles;
    }
}

bool StripChart::is_above_faces(const Event& event) const {
    const auto is_above_them = [this](std::uint32_t p) {
        return pieces_[p].visibility == Visibility::kAbove;
    };
    return std::any_of(event.arriving.begin(),
                       event.arriving.begin() + event.num_arriving,
                       is_above_them) ||
           std::any_of(
               event.leaving.begin(), event.leaving.begin() + event.num_leaving, is_above_them);
}

void StripChart::sort_events() {
    num_steps_ += order_.size();
    // each camera's events are in order already: insertion is the fastest merge of few
    sort_few(order_, [this](std::uint32_t l, std::uint32_t r) { return is_before(l, r); });
}

}  // namespace atrium::hull
