#include "site_node/hull/strip_chart.hpp"

#include "site_node/hull/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace atrium::hull {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

void StripChart::start(const Cones& cones, const Pencils& pencils, std::uint32_t strip) {
    cones_ = &cones;
    pencils_ = &pencils;
    view_ = cones.strips[strip].view;
    infinity_toggles_ = {std::uint64_t{1} << view_, 0};
    is_degenerate_ = false;
    num_steps_ = 0;
    if (active_.size() < cones.num_views()) active_.resize(cones.num_views());
    to_norm_ = cones.ray[cones.strips[strip].from].norm();
    find_active(cones.strips[strip].from);
    go_on(strip);
}

void StripChart::go_on(std::uint32_t strip) {
    strip_ = strip;
    from_norm_ = to_norm_;
    to_norm_ = cones_->ray[cones_->strips[strip].to].norm();
}

// The lines that meet `ray`, and what the cameras say about this camera's own place.
void StripChart::find_active(std::uint32_t ray) {
    const std::uint32_t local_ray = ray - cones_->views[view_].first_ray;
    verdict_at_centre_ = {};
    for (std::uint32_t k = 0; k < cones_->num_views(); ++k) {
        active_[k].clear();
        if (k == view_) continue;
        const Cones::View& view = cones_->views[k];
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
            const Value value = value_at(strip, cones_->ray[ray], to_norm_);
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
StripChart::Value StripChart::value_at(std::uint32_t strip,
                                       const Eigen::Vector3d& ray,
                                       double ray_norm) const {
    const std::uint32_t k = cones_->strips[strip].view;
    const PencilSide& other = pencils_->side(k, view_);
    const std::uint32_t local = strip - cones_->views[k].first_strip;
    const double offset = other.offset[local];
    const double certain = std::abs(offset) - other.offset_error[local];
    if (!(certain > 0.0)) return {0.0, kInfinity};
    const double u = -cones_->normal[strip].dot(ray) / offset;
    const double numerator_error = 10.0 * kRounding * cones_->normal_bound[strip] * ray_norm;
    return {u, (numerator_error + std::abs(u) * other.offset_error[local]) / certain};
}

void StripChart::open_piece(Active& active,
                            std::uint32_t view,
                            std::uint32_t start_event,
                            double phi) {
    const Value at_to = value_at(active.strip, cones_->ray[cones_->strips[strip_].to], to_norm_);
    Piece piece;
    piece.strip = active.strip;
    piece.view = static_cast<std::uint8_t>(view);
    piece.at_from = active.u;
    piece.slope = at_to.u - active.u;
    piece.error = std::max(active.error, at_to.error);
    piece.start_event = start_event;
    piece.start_phi = phi;
    active.piece = static_cast<std::uint32_t>(pieces_.size());
    active.u = at_to.u;  // for the next strip
    active.error = at_to.error;
    pieces_.push_back(piece);
}

bool StripChart::collect() {
    pieces_.clear();
    events_.clear();
    order_.clear();
    phi_error_ = 4.0 * kRounding;
    infinity_ = kNone;
    first_piece_.resize(cones_->num_views() + 1);
    for (std::uint32_t k = 0; k < cones_->num_views(); ++k) {
        first_piece_[k] = static_cast<std::uint32_t>(pieces_.size());
        if (k == view_) continue;
        for (Active& active : active_[k]) open_piece(active, k, kNone, 0.0);
        if (!collect_events(k)) return false;
    }
    first_piece_[cones_->num_views()] = static_cast<std::uint32_t>(pieces_.size());
    num_steps_ += pieces_.size();
    bound_pieces();
    highest_ = kInfinity;
    lowest_ = -kInfinity;
    for (std::uint32_t k = 0; k < cones_->num_views(); ++k) {
        if (k != view_) bound_faces(k);
    }
    // faces end at infinity, u = 0
    const bool may_reach_infinity = lowest_ <= 0.0;
    lowest_ = std::max(lowest_, 0.0);
    if (!may_have_faces()) return true;
    hide_pieces();
    if (may_reach_infinity) {
        infinity_ = static_cast<std::uint32_t>(pieces_.size());
        Piece infinity;
        infinity.strip = kInfinityStrip;
        infinity.view = static_cast<std::uint8_t>(view_);
        pieces_.push_back(infinity);
    }
    sort_events();
    return true;
}

double StripChart::phi_of(const PencilSide& own, const Eigen::Vector2d& across, double ray_norm) {
    const std::uint32_t first = cones_->views[view_].first_ray;
    const Eigen::Vector2d& a0 = own.across[cones_->strips[strip_].from - first];
    const Eigen::Vector2d& a1 = own.across[cones_->strips[strip_].to - first];
    const double w_to = std::abs(across.x() * a0.y() - across.y() * a0.x());
    const double w_from = std::abs(across.x() * a1.y() - across.y() * a1.x());
    const double sum = w_from + w_to;
    const double error = 32.0 * kRounding * ray_norm * std::max(from_norm_, to_norm_);
    phi_error_ = std::max(phi_error_, error < sum ? 2.0 * error / sum : 1.0);
    return sum > 0.0 ? w_to / sum : 0.0;
}

bool StripChart::collect_events(std::uint32_t k) {
    const PencilSide& own = pencils_->side(view_, k);
    const PencilSide& other = pencils_->side(k, view_);
    const Cones::Strip& strip = cones_->strips[strip_];
    const std::uint32_t from_ray = strip.from - cones_->views[view_].first_ray;
    const std::uint32_t to_ray = strip.to - cones_->views[view_].first_ray;
    const auto n = static_cast<std::uint32_t>(other.sorted.size());
    if (n == 0) return true;
    const bool rising = own.rises[strip_ - cones_->views[view_].first_strip] != 0;
    const std::uint32_t from = own.rank[from_ray];
    const std::uint32_t to = own.rank[to_ray];
    // the ranks alone do not tell no ray from all rays: the arc may cross the end of the circle
    const bool wraps = (own.position[to_ray] < own.position[from_ray]) == rising;
    const std::uint32_t count = (rising ? to - from : from - to) + (wraps ? n : 0);
    std::uint32_t position = rising ? from : from + n - 1;
    if (position >= n) position -= n;
    double last_phi = 0.0;
    for (std::uint32_t e = 0; e < count; ++e) {
        const std::uint32_t local = other.sorted[position];
        const std::uint32_t ray = cones_->views[k].first_ray + local;
        const double phi = phi_of(own, other.across[local], cones_->ray[ray].norm());
        // the order around the baseline is what counts; phi only has to follow it
        last_phi = std::clamp(phi, last_phi, 1.0);
        if (!add_event(k, ray, last_phi, rising)) return false;
        position = rising ? (position + 1 == n ? 0 : position + 1)
                          : (position == 0 ? n - 1 : position - 1);
    }
    return true;
}

// The strips that meet in `ray` end or begin here, seen along this strip.
bool StripChart::add_event(std::uint32_t k, std::uint32_t ray, double phi, bool rising) {
    const PencilSide& other = pencils_->side(k, view_);
    const Cones::Incidence& incidence = cones_->incidence[ray];
    if (incidence.count > incidence.strips.size()) return false;
    const auto index = static_cast<std::uint32_t>(events_.size());
    std::vector<Active>& active = active_[k];
    Event event;
    event.phi = phi;
    event.ray = ray;
    event.view = k;
    std::array<std::uint32_t, 3> leaving{};
    for (std::uint32_t j = 0; j < incidence.count; ++j) {
        const std::uint32_t strip = incidence.strips[j];
        const bool strip_rises = other.rises[strip - cones_->views[k].first_strip] != 0;
        const bool is_upper_end = (cones_->strips[strip].to == ray) == strip_rises;
        if (is_upper_end != rising) {
            leaving[event.num_leaving++] = strip;
            continue;
        }
        const auto found = std::find_if(active.begin(), active.end(), [strip](const Active& a) {
            return a.strip == strip;
        });
        if (found == active.end()) return false;
        pieces_[found->piece].end_event = index;
        pieces_[found->piece].end_phi = phi;
        event.arriving[event.num_arriving++] = found->piece;
        *found = active.back();
        active.pop_back();
    }
    const Eigen::Vector3d& from_ray = cones_->ray[cones_->strips[strip_].from];
    for (std::uint32_t j = 0; j < event.num_leaving; ++j) {
        const Value at_from = value_at(leaving[j], from_ray, from_norm_);
        active.push_back({leaving[j], at_from.u, at_from.error, 0});
        open_piece(active.back(), k, index, phi);
        event.leaving[j] = active.back().piece;
    }
    events_.push_back(event);
    return true;
}

void StripChart::bound_pieces() {
    for (Piece& piece : pieces_) {
        const double at_start = piece.at_from + piece.start_phi * piece.slope;
        const double at_end = piece.at_from + piece.end_phi * piece.slope;
        piece.error += std::abs(piece.slope) * phi_error_ +
                       8.0 * kRounding * (std::abs(piece.at_from) + std::abs(piece.slope));
        piece.min_u = std::min(at_start, at_end) - piece.error;
        piece.max_u = std::max(at_start, at_end) + piece.error;
    }
}

// Where camera k leaves room for faces.
void StripChart::bound_faces(std::uint32_t k) {
    const std::uint64_t bit = std::uint64_t{1} << k;
    double nearest = -kInfinity;
    double farthest = kInfinity;
    std::uint64_t crossed_at_start = 0;
    for (std::uint32_t p = first_piece_[k]; p < first_piece_[k + 1]; ++p) {
        const Piece& piece = pieces_[p];
        if (cones_->strips[piece.strip].toggles.carved == 0) continue;
        nearest = std::max(nearest, piece.max_u);
        farthest = std::min(farthest, piece.min_u);
        if (piece.start_event == kNone) crossed_at_start ^= bit;
    }
    const std::uint64_t above = verdict_at_centre_.carved & bit;
    if (above != 0) highest_ = std::min(highest_, nearest);
    if ((above ^ crossed_at_start) != 0) lowest_ = std::max(lowest_, farthest);
}

void StripChart::hide_pieces() {
    verdict_above_ = verdict_at_centre_;
    for (Piece& piece : pieces_) {
        if (piece.min_u > highest_) {
            piece.visibility = Visibility::kAbove;
            if (piece.start_event == kNone) verdict_above_ ^= cones_->strips[piece.strip].toggles;
        } else if (piece.max_u < lowest_) {
            piece.visibility = Visibility::kBelow;
        }
    }
    for (std::uint32_t e = 0; e < events_.size(); ++e) {
        Event& event = events_[e];
        std::uint32_t num_visible = 0;
        for (std::uint32_t j = 0; j < event.num_arriving; ++j)
            num_visible += pieces_[event.arriving[j]].visibility == Visibility::kVisible ? 1u : 0u;
        for (std::uint32_t j = 0; j < event.num_leaving; ++j)
            num_visible += pieces_[event.leaving[j]].visibility == Visibility::kVisible ? 1u : 0u;
        event.is_wholly_visible = num_visible == event.num_arriving + event.num_leaving;
        if (num_visible > 0) order_.push_back(e);
    }
}

bool StripChart::is_above_faces(const Event& event) const {
    const auto is_above_them = [this](std::uint32_t p) {
        return pieces_[p].visibility == Visibility::kAbove;
    };
    return std::any_of(
               event.arriving.begin(), event.arriving.begin() + event.num_arriving, is_above_them) ||
           std::any_of(
               event.leaving.begin(), event.leaving.begin() + event.num_leaving, is_above_them);
}

void StripChart::sort_events() {
    num_steps_ += order_.size();
    const auto before = [this](std::uint32_t l, std::uint32_t r) { return is_before(l, r); };
    constexpr std::size_t kFew = 64;
    if (order_.size() > kFew) {
        std::sort(order_.begin(), order_.end(), before);
        return;
    }
    // each camera's events are in order already: insertion is the fastest merge of few
    for (std::size_t i = 1; i < order_.size(); ++i) {
        const std::uint32_t e = order_[i];
        std::size_t at = i;
        for (; at > 0 && is_before(e, order_[at - 1]); --at) order_[at] = order_[at - 1];
        order_[at] = e;
    }
}

bool StripChart::is_before(std::uint32_t l, std::uint32_t r) {
    if (l == r) return false;
    if (events_[l].view == events_[r].view) return l < r;
    const double difference = events_[r].phi - events_[l].phi;
    if (std::abs(difference) > 2.0 * phi_error_) return difference > 0.0;
    const int order = exact::compare_phi(exact_place({0.0, l}), exact_place({0.0, r}));
    is_degenerate_ |= order == 0;
    return order < 0;
}

bool StripChart::is_above(std::uint32_t upper, std::uint32_t lower, const Place& at) {
    const double difference = u(upper, at.phi) - u(lower, at.phi);
    if (std::abs(difference) > pieces_[upper].error + pieces_[lower].error) return difference > 0.0;
    const int order = exact::compare_u(exact_line(upper), exact_line(lower), exact_place(at));
    is_degenerate_ |= order == 0;
    return order > 0;
}

bool StripChart::is_steeper(std::uint32_t l, std::uint32_t r) {
    const double difference = pieces_[l].slope - pieces_[r].slope;
    // the error of u holds at both rays
    if (std::abs(difference) > 2.0 * (pieces_[l].error + pieces_[r].error)) return difference > 0.0;
    const int order = exact::compare_slope(exact_line(l), exact_line(r));
    is_degenerate_ |= order == 0;
    return order > 0;
}

bool StripChart::crosses_before(std::uint32_t l1,
                                std::uint32_t l2,
                                std::uint32_t r1,
                                std::uint32_t r2) {
    const auto phi_with_error = [this](std::uint32_t a, std::uint32_t b, double& error) {
        const double from = pieces_[a].at_from - pieces_[b].at_from;
        const double turn = pieces_[b].slope - pieces_[a].slope;
        error = 4.0 * (pieces_[a].error + pieces_[b].error) / std::abs(turn);
        return from / turn;
    };
    double l_error = 0.0;
    double r_error = 0.0;
    const double l = phi_with_error(l1, l2, l_error);
    const double r = phi_with_error(r1, r2, r_error);
    // an error that is not small says nothing about itself
    if (l_error < 1e-3 && r_error < 1e-3 && std::abs(l - r) > l_error + r_error) return l < r;
    const int order = exact::compare_crossings(
        exact_line(l1), exact_line(l2), exact_line(r1), exact_line(r2));
    is_degenerate_ |= order == 0;
    return order < 0;
}

exact::Line StripChart::exact_line(std::uint32_t piece) const {
    const std::uint32_t other = pieces_[piece].strip;
    if (other == kInfinityStrip) return exact::kInfinity;
    const Cones::Strip& cut = cones_->strips[other];
    const Cones::Strip& own = cones_->strips[strip_];
    return exact::line_of(cones_->exact_ray[cut.from],
                          cones_->exact_ray[cut.to],
                          cones_->exact_ray[own.from],
                          cones_->exact_ray[own.to],
                          cones_->exact_baseline(cut.view, view_));
}

exact::Place StripChart::exact_place(const Place& at) const {
    if (at.event == kNone) return at.phi < 0.5 ? exact::Place{1, 0} : exact::Place{0, 1};
    const Event& event = events_[at.event];
    const Cones::Strip& own = cones_->strips[strip_];
    return exact::place_of(cones_->exact_ray[event.ray],
                           cones_->exact_baseline(view_, event.view),
                           cones_->exact_ray[own.from],
                           cones_->exact_ray[own.to]);
}

namespace {

// Beyond this the doubles are too rough for a vertex.
constexpr double kGoodEnough = 1e-10;

}  // namespace

StripChart::Point StripChart::point(std::uint32_t piece, const Place& at) const {
    const double approximate = u(piece, at.phi);
    if (pieces_[piece].error < kGoodEnough * std::abs(approximate)) return {at.phi, approximate};
    const double scale = exact_unit();
    return {at.phi, scale * exact::u_of(exact_line(piece), exact_place(at))};
}

StripChart::Point StripChart::crossing(std::uint32_t l,
                                       std::uint32_t r,
                                       double min_phi,
                                       double max_phi) const {
    const Piece& a = pieces_[l];
    const Piece& b = pieces_[r];
    const double turn = b.slope - a.slope;
    const double phi = (a.at_from - b.at_from) / turn;
    const Piece& better = a.error < b.error ? a : b;
    const Point point{phi, better.at_from + phi * better.slope};
    const double phi_error = (a.error + b.error) / std::abs(turn);
    if (phi_error < kGoodEnough && min_phi <= phi && phi <= max_phi &&
        better.error < kGoodEnough * std::abs(point.u)) {
        return point;
    }
    const exact::Point exact = exact::crossing_of(exact_line(l), exact_line(r));
    return {std::clamp(exact.phi, 0.0, 1.0), exact_unit() * exact.u};
}

Eigen::Vector3d StripChart::position(const Point& p) const {
    const Eigen::Vector3d& from = cones_->ray[cones_->strips[strip_].from];
    const Eigen::Vector3d& to = cones_->ray[cones_->strips[strip_].to];
    return cones_->views[view_].centre + (from + p.phi * (to - from)) / p.u;
}

}  // namespace atrium::hull
