#include "site_node/hull/strip_chart.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::hull {
namespace {

// Relative error above which doubles are too inaccurate for a vertex.
constexpr double kGoodEnough = 1e-10;

}  // namespace

bool StripChart::is_exactly_before(const Entry& l, const Entry& r) {
    const int order = exact::compare_phi(exact_place(place(l.event)), exact_place(place(r.event)));
    is_degenerate_ |= order == 0;
    return order < 0;
}

bool StripChart::is_exactly_above(std::uint32_t upper, std::uint32_t lower, const Place& at) {
    const int order = exact::compare_u(exact_line(upper), exact_line(lower), exact_place(at));
    is_degenerate_ |= order == 0;
    return order > 0;
}

bool StripChart::is_steeper(std::uint32_t l, std::uint32_t r) {
    const double difference = pieces_[l].slope - pieces_[r].slope;
    // the error bound of u holds at both rays
    if (is_certain(difference, 2.0 * (pieces_[l].error + pieces_[r].error)))
        return difference > 0.0;
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
    // the bound is of first order, so it is valid only if it is small
    if (l_error < 1e-3 && r_error < 1e-3 && is_certain(l - r, l_error + r_error)) return l < r;
    const int order =
        exact::compare_crossings(exact_line(l1), exact_line(l2), exact_line(r1), exact_line(r2));
    is_degenerate_ |= order == 0;
    return order < 0;
}

exact::Line StripChart::exact_line(std::uint32_t piece) const {
    const std::uint32_t other = pieces_[piece].strip;
    if (other == kInfinityStrip) return exact::kInfinity;
    const Cones::Strip& cut = cones_->strips[other];
    return exact::line_of(cones_->exact_ray[cut.from],
                          cones_->exact_ray[cut.to],
                          cones_->exact_ray[own_.from],
                          cones_->exact_ray[own_.to],
                          cones_->exact_baseline(cut.view, view_));
}

exact::Place StripChart::exact_place(const Place& at) const {
    if (at.event == kNone) return at.phi < 0.5 ? exact::Place{1, 0} : exact::Place{0, 1};
    const Event& event = events_[at.event];
    return exact::place_of(cones_->exact_ray[event.ray],
                           cones_->exact_baseline(view_, event.view),
                           cones_->exact_ray[own_.from],
                           cones_->exact_ray[own_.to]);
}

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
    const Eigen::Vector3d& from = cones_->ray[own_.from];
    const Eigen::Vector3d& to = cones_->ray[own_.to];
    return cones_->views[view_].centre + (from + p.phi * (to - from)) / p.u;
}

}  // namespace atrium::hull
