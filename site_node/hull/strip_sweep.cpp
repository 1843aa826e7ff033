#include "site_node/hull/strip_sweep.hpp"

#include "site_node/hull/sort_few.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::hull {

void StripSweep::run(const Cones& cones,
                     const Pencils& pencils,
                     const StripRun& run,
                     std::uint64_t max_steps,
                     RunFaces& faces) {
    cones_ = &cones;
    faces_ = &faces;
    max_steps_ = max_steps;
    num_steps_ = 0;
    faces.clear();
    ray_vertices_.clear();
    chart_.start(cones, pencils, run.first, max_steps);
    for (std::uint32_t strip = run.first; strip < run.first + run.count; ++strip) {
        if (strip > run.first) chart_.go_on(strip);
        strip_ = strip;
        own_ = cones.strips[strip];
        sweep_strip();
        if (must_stop()) break;
    }
    faces.failed |= chart_.is_degenerate();
    faces.num_steps = num_steps_ + chart_.num_steps();
}

void StripSweep::sweep_strip() {
    phi_ = 0.0;
    if (!chart_.collect()) {
        faces_->failed = true;
        return;
    }
    if (must_stop()) return;
    if (!chart_.may_have_faces()) {
        ray_vertices_.clear();
        return;
    }
    enter_lines();
    start_corners();
    begin_faces();
    for (const std::uint32_t e : chart_.order()) {
        if (must_stop()) return;
        advance(chart_.place(e));
        if (must_stop()) return;
        handle(e);
    }
    if (must_stop()) return;
    advance(StripChart::kEnd);
    if (must_stop()) return;
    end_faces();
    finish_triangles();
}

StripSweep::Line StripSweep::make_line(std::uint32_t piece) const {
    Line line;
    line.piece = piece;
    const StripChart::Piece& of = chart_.piece(piece);
    line.strip = of.strip;
    line.at_from = of.at_from;
    line.slope = of.slope;
    line.error = of.error;
    return line;
}

// All visible lines at the strip's first ray, in order.
void StripSweep::enter_lines() {
    const auto is_above = [this](std::uint32_t upper, std::uint32_t lower) {
        return upper != lower && chart_.is_above(upper, lower, StripChart::kStart);
    };
    const std::span<const std::uint32_t> visible = chart_.visible_at_start();
    entering_.assign(visible.begin(), visible.end());
    sort_few(entering_, is_above);
    num_steps_ += visible.size() + 1;
    Verdict verdict = chart_.verdict_above();
    lines_.clear();
    Line& centre = lines_.emplace_back();
    centre.strip = kNoStrip;
    centre.u = std::numeric_limits<double>::infinity();
    set_below(centre, verdict);
    for (const std::uint32_t p : entering_) {
        Line& line = lines_.emplace_back(make_line(p));
        line.u = line.at_from;
        verdict ^= chart_.toggles(p);
        set_below(line, verdict);
    }
}

// The line that ends the face below line `top`; 0 if none does.
std::size_t StripSweep::end_of_face(std::size_t top) const {
    for (std::size_t p = top + 1; p < lines_.size(); ++p) {
        if (!lines_[p].face_below) return p;
    }
    return 0;
}

// Inside of a face, on a ray of three strips: whether faces on the other two begin or end here.
bool StripSweep::is_ray_vertex(const Line& line, const Line& above) const {
    if (own_.kind != SegmentKind::kSilhouette) return false;
    const int seen_above = std::popcount(above.below.seen);
    const int seen_below = std::popcount(line.below.seen);
    const auto least = static_cast<int>(own_.min_seen);
    return seen_above != seen_below && std::min(seen_above, seen_below) == least;
}

// Calls `visit(top, bottom)` for the lines that bound each face at the place of the sweep.
template <typename Visit>
void StripSweep::for_each_face(const Visit& visit) {
    for (std::size_t top = 0; top < lines_.size(); ++top) {
        if (!lines_[top].face_below) continue;
        const std::size_t bottom = end_of_face(top);
        if (bottom == 0) {
            faces_->failed = true;
            return;
        }
        visit(top, bottom);
        top = bottom - 1;
    }
}

void StripSweep::begin_faces() {
    const std::uint32_t ray = own_.from;
    const bool has_three = cones_->incidence[ray].count == 3;
    for_each_face([&](std::size_t top, std::size_t bottom) {
        std::uint32_t last = lines_[top].edge_start = ray_vertex(ray, lines_[top]);
        const Corner first = ray_corner(last, 0.0, lines_[top]);
        RegionId region = -1;
        for (std::size_t p = top + 1; p <= bottom; ++p) {
            if (p < bottom && !(has_three && is_ray_vertex(lines_[p], lines_[p - 1]))) continue;
            const std::uint32_t v = ray_vertex(ray, lines_[p]);
            const Corner next = ray_corner(v, 0.0, lines_[p]);
            if (region < 0) {
                region = triangulator_.open(first, next);
            } else {
                triangulator_.add(region, next, Side::kBottom);
            }
            faces_->edges.emplace_back(v, last);
            last = v;
        }
        lines_[bottom].edge_start = last;
        for (std::size_t p = top; p < bottom; ++p) lines_[p].region_below = region;
    });
}

void StripSweep::end_faces() {
    ray_vertices_.clear();
    const std::uint32_t ray = own_.to;
    const bool has_three = cones_->incidence[ray].count == 3;
    for_each_face([&](std::size_t top, std::size_t bottom) {
        const RegionId region = lines_[top].region_below;
        std::uint32_t last = lines_[top].edge_start;  // the centre stays where it is
        if (top > 0) {
            last = ray_vertex(ray, lines_[top]);
            ray_vertices_.emplace_back(lines_[top].strip, last);
            triangulator_.add(region, ray_corner(last, 1.0, lines_[top]), Side::kTop);
            end_edge(lines_[top], last, Side::kTop);
        }
        for (std::size_t p = top + 1; p <= bottom; ++p) {
            if (p < bottom && !(has_three && is_ray_vertex(lines_[p], lines_[p - 1]))) continue;
            const std::uint32_t v = ray_vertex(ray, lines_[p]);
            ray_vertices_.emplace_back(lines_[p].strip, v);
            const Corner corner = ray_corner(v, 1.0, lines_[p]);
            if (p < bottom) {
                triangulator_.add(region, corner, Side::kTop);
            } else {
                triangulator_.close(region, corner);
                end_edge(lines_[p], v, Side::kBottom);
            }
            faces_->edges.emplace_back(last, v);
            last = v;
        }
    });
}

// Two lines that end in this very event meet there; all others have an order.
bool StripSweep::is_reversed(std::size_t p, const Place& at) {
    const Line& upper = lines_[p];
    const Line& lower = lines_[p + 1];
    if (upper.u - lower.u > upper.u_error + lower.u_error && !cones_->only_exact) return false;
    if (at.event != StripChart::kNone && chart_.piece(upper.piece).end_event == at.event &&
        chart_.piece(lower.piece).end_event == at.event) {
        return false;
    }
    return chart_.is_above(lower.piece, upper.piece, at);
}

// Moves all lines on, exchanging neighbours in the order in which they cross on the way.
void StripSweep::advance(const Place& at) {
    num_steps_ += lines_.size();
    bool are_in_order = !cones_->only_exact;
    double least_above = std::numeric_limits<double>::infinity();
    for (std::size_t p = 1; p < lines_.size(); ++p) {
        Line& line = lines_[p];
        line.u = line.at_from + at.phi * line.slope;
        line.u_error = line.error + at.phi_error * std::abs(line.slope);
        are_in_order &= least_above > line.u + line.u_error;
        least_above = line.u - line.u_error;
    }
    while (!are_in_order) {
        // the next crossing is always one of neighbours
        std::size_t first = 0;
        for (std::size_t p = 1; p + 1 < lines_.size(); ++p) {
            if (!is_reversed(p, at)) continue;
            if (first == 0 || chart_.crosses_before(lines_[p].piece,
                                                    lines_[p + 1].piece,
                                                    lines_[first].piece,
                                                    lines_[first + 1].piece)) {
                first = p;
            }
        }
        if (first == 0) break;
        cross(first, at);
        num_steps_ += lines_.size();
        if (must_stop()) return;
    }
    phi_ = at.phi;
}

void StripSweep::cross(std::size_t p, const Place& at) {
    const StripChart::Point point =
        chart_.crossing(lines_[p].piece, lines_[p + 1].piece, phi_, at.phi);
    leaving_.clear();
    leaving_.push_back(lines_[p + 1]);
    leaving_.push_back(lines_[p]);
    turn_at_crossing(p, point);
}

// Lines that begin in the event, from the upper to the lower.
void StripSweep::collect_leaving(const StripChart::Event& event) {
    leaving_.clear();
    for (std::uint32_t j = 0; j < event.num_leaving; ++j) {
        const std::uint32_t piece = event.leaving[j];
        if (chart_.piece(piece).visibility != StripChart::Visibility::kVisible) continue;
        std::size_t at = leaving_.size();
        while (at > 0 && chart_.is_steeper(piece, leaving_[at - 1].piece)) --at;
        leaving_.insert(leaving_.begin() + static_cast<std::ptrdiff_t>(at), make_line(piece));
        leaving_[at].u = chart_.u(piece, event.phi);
    }
}

// Where a line belongs that begins at `at`.
std::size_t StripSweep::place_of(std::uint32_t piece, const Place& at) {
    std::size_t p = 1;
    while (p < lines_.size() && chart_.is_above(lines_[p].piece, piece, at)) ++p;
    num_steps_ += p;
    return p;
}

void StripSweep::handle(std::uint32_t e) {
    const StripChart::Event& event = chart_.event(e);
    const Place at = chart_.place(e);
    const auto arrives = [&](const Line& line) {
        return line.piece != StripChart::kNone && chart_.piece(line.piece).end_event == e;
    };
    collect_leaving(event);
    if (!event.is_wholly_visible) {
        // no face is near: only the verdicts have to stay right
        const bool is_above = chart_.is_above_faces(event);
        for (std::size_t p = lines_.size(); p-- > 1;) {
            if (arrives(lines_[p])) hide(p, is_above);
        }
        if (leaving_.empty()) return;
        std::size_t p = place_of(leaving_[0].piece, at);
        for (const Line& line : leaving_) show(p++, line, is_above);
        return;
    }
    if (event.num_arriving == 0) {
        turn_at_event(place_of(leaving_[0].piece, at), 0, e);
        return;
    }
    std::size_t first = 1;
    while (first < lines_.size() && !arrives(lines_[first])) ++first;
    for (std::size_t j = 0; j < event.num_arriving; ++j) {
        if (first + j < lines_.size() && arrives(lines_[first + j])) continue;
        faces_->failed = true;
        return;
    }
    turn_at_event(first, event.num_arriving, e);
}

// A line leaves the visible range upwards or downwards, crossing all that are on its way.
void StripSweep::hide(std::size_t p, bool upwards) {
    const Verdict toggles = chart_.toggles(lines_[p].piece);
    lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(p));
    const std::size_t begin = upwards ? 0 : p;
    const std::size_t end = upwards ? p : lines_.size();
    num_steps_ += 1 + lines_.size() / 4;
    for (std::size_t q = begin; q < end; ++q) set_below(lines_[q], lines_[q].below ^ toggles);
}

void StripSweep::show(std::size_t p, const Line& line, bool from_above) {
    const Verdict toggles = chart_.toggles(line.piece);
    const Verdict around = lines_[p - 1].below;
    lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(p), line);
    set_below(lines_[p], from_above ? around : around ^ toggles);
    const std::size_t begin = from_above ? 0 : p + 1;
    const std::size_t end = from_above ? p : lines_.size();
    num_steps_ += 1 + lines_.size() / 4;
    for (std::size_t q = begin; q < end; ++q) set_below(lines_[q], lines_[q].below ^ toggles);
}

}  // namespace atrium::hull
