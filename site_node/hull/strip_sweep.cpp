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

// Starts the list with all visible lines at the strip's first ray.
void StripSweep::enter_lines() {
    const std::span<const std::uint32_t> visible = chart_.visible_at_start();
    entering_.clear();
    for (const std::uint32_t p : visible)
        entering_.push_back({chart_.piece(p).at_from, chart_.piece(p).error, p});
    sort_few(std::span<Entering>(entering_), [this](const Entering& upper, const Entering& lower) {
        const double difference = upper.u - lower.u;
        if (std::abs(difference) > upper.error + lower.error && !cones_->only_exact)
            return difference > 0.0;
        return upper.piece != lower.piece &&
               chart_.is_above(upper.piece, lower.piece, StripChart::kStart);
    });
    num_steps_ += visible.size() + 1;
    Verdict verdict = chart_.verdict_above();
    lines_.clear();
    Line& centre = lines_.emplace_back();
    centre.strip = kNoStrip;
    centre.meets_at = std::numeric_limits<double>::infinity();
    set_below(centre, verdict);
    for (const Entering& entering : entering_) {
        Line& line = lines_.emplace_back(make_line(entering.piece));
        verdict ^= chart_.toggles(entering.piece);
        set_below(line, verdict);
    }
    next_meeting_ = std::numeric_limits<double>::infinity();
    for (std::size_t p = 1; p < lines_.size(); ++p) find_meeting(p);
}

// Returns the line that bounds the face below line `top` from below; 0 if none does.
std::size_t StripSweep::end_of_face(std::size_t top) const {
    for (std::size_t p = top + 1; p < lines_.size(); ++p) {
        if (!lines_[p].face_below) return p;
    }
    return 0;
}

// For a line inside a face, on a ray of three strips: returns whether faces on the other two strips
// begin or end here.
bool StripSweep::is_ray_vertex(const Line& line, const Line& above) const {
    if (own_.kind != SegmentKind::kSilhouette) return false;
    const int seen_above = std::popcount(above.below.seen);
    const int seen_below = std::popcount(line.below.seen);
    const auto least = static_cast<int>(own_.min_seen);
    return seen_above != seen_below && std::min(seen_above, seen_below) == least;
}

// Calls `visit(top, bottom)` with the two lines that bound each face at the sweep line.
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
        std::uint32_t last = lines_[top].edge_start;  // the centre is one vertex for both rays
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

// Finds a phi before which line p and the line below it do not meet. It holds until one of them
// gets another neighbour, because two lines meet at most once.
void StripSweep::find_meeting(std::size_t p) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    if (p == 0) return;  // the centre is above all lines
    Line& line = lines_[p];
    const Line* const next = &line + 1;
    if (next == lines_.data() + lines_.size()) {
        line.meets_at = kNever;
        return;
    }
    const StripChart::Piece& upper = chart_.piece(line.piece);
    const StripChart::Piece& lower = chart_.piece(next->piece);
    const double from = upper.at_from - lower.at_from;
    const double turn = lower.slope - upper.slope;
    const double error = upper.error + lower.error;
    const bool may_be_certain = !cones_->only_exact;
    // no branch: unpredictable
    const bool end_together =
        (upper.end_event == lower.end_event) & (upper.end_event != StripChart::kNone);
    const bool begin_together =
        (upper.start_event == lower.start_event) & (upper.start_event != StripChart::kNone);
    const bool is_above_at_end = (from - turn > error) & may_be_certain;
    // the bound is of first order, so it is valid only if it is small
    const bool is_known = (4.0 * error < 1e-3 * turn) & may_be_certain;
    const bool never_meet = end_together | begin_together | is_above_at_end;
    static constexpr double kEnds[] = {-kNever, kNever};
    line.meets_at =
        std::max(kEnds[never_meet], std::min(kEnds[is_known], (from - 4.0 * error) / turn));
    next_meeting_ = std::min(next_meeting_, line.meets_at);
}

// Returns whether lines p and p + 1 have met before `at`. Two lines that end in the event `at` meet
// there, which does not count.
bool StripSweep::is_reversed(std::size_t p, const Place& at) {
    const Line& upper = lines_[p];
    const Line& lower = lines_[p + 1];
    if (at.event != StripChart::kNone && upper.end_event == at.event &&
        lower.end_event == at.event) {
        return false;
    }
    return chart_.is_above(lower.piece, upper.piece, at);
}

// Returns the line with the first crossing among those that have met their lower neighbour before
// `at`; 0 if none has. Updates `next_meeting_`.
std::size_t StripSweep::first_crossing(const Place& at, double limit) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    if (near_.size() < lines_.size()) near_.resize(2 * lines_.size());
    const Line* const lines = lines_.data();
    const std::size_t last = lines_.size() - 1;
    std::uint32_t* const near = near_.data();
    std::size_t num_near = 0;
    double next = kNever;
    for (std::size_t p = 1; p < last; ++p) {  // no branch: unpredictable
        const double meets_at = lines[p].meets_at;
        const bool is_near = meets_at <= limit;
        near[num_near] = static_cast<std::uint32_t>(p);
        num_near += is_near ? 1 : 0;
        next = std::min(next, is_near ? kNever : meets_at);
    }
    std::size_t first = 0;
    for (std::size_t n = 0; n < num_near; ++n) {
        const std::size_t p = near[n];
        const bool is_first =
            is_reversed(p, at) &&
            (first == 0 ||
             chart_.crosses_before(
                 lines[p].piece, lines[p + 1].piece, lines[first].piece, lines[first + 1].piece));
        if (!is_first) {
            next = std::min(next, lines[p].meets_at);
            continue;
        }
        if (first != 0) next = std::min(next, lines[first].meets_at);
        first = p;
    }
    next_meeting_ = next;
    return first;
}

// Moves the sweep line to `at`, exchanging neighbours in the order of their crossings.
void StripSweep::advance(const Place& at) {
    const double limit = at.phi + at.phi_error;
    ++num_steps_;
    while (next_meeting_ <= limit) {
        // the next crossing is always one of two neighbours
        num_steps_ += lines_.size();
        const std::size_t first = first_crossing(at, limit);
        if (first == 0) break;
        cross(first, at);
        if (must_stop()) return;
    }
    phi_ = at.phi;
}

void StripSweep::cross(std::size_t p, const Place& at) {
    const Verdict between = lines_[p - 1].below ^ chart_.toggles(lines_[p + 1].piece);
    if ((between ^ chart_.toggles(lines_[p].piece)) != lines_[p + 1].below) {
        faces_->failed = true;
        return;
    }
    const bool has_face_between = cones_->has_face(own_, between);
    const int num_faces = int{lines_[p - 1].face_below} + int{lines_[p].face_below} +
                          int{lines_[p + 1].face_below} + int{has_face_between};
    if (num_faces == 0) {
        exchange_neighbours(p, between, has_face_between);
        return;
    }
    const StripChart::Point point =
        chart_.crossing(lines_[p].piece, lines_[p + 1].piece, phi_, at.phi);
    if (num_faces == 1) {
        cross_at_one_face(p, point, between, has_face_between);
        return;
    }
    leaving_.clear();
    leaving_.insert(0, lines_[p + 1]);
    leaving_.insert(1, lines_[p]);
    turn_at_crossing(p, point);
}

// Exchanges lines p and p + 1. `between`: the verdict between them after their crossing.
void StripSweep::exchange_neighbours(std::size_t p, const Verdict& between, bool has_face_between) {
    Line& upper = lines_[p];
    Line& lower = lines_[p + 1];
    std::swap(upper.piece, lower.piece);
    std::swap(upper.strip, lower.strip);
    std::swap(upper.end_event, lower.end_event);
    upper.below = between;
    upper.face_below = has_face_between;
    find_meeting(p - 1);
    upper.meets_at = std::numeric_limits<double>::infinity();  // they have met already
    find_meeting(p + 1);
}

// Collects the lines that begin in the event, from the upper to the lower one.
void StripSweep::collect_leaving(const StripChart::Event& event) {
    leaving_.clear();
    for (std::uint32_t j = 0; j < event.num_leaving; ++j) {
        const std::uint32_t piece = event.leaving[j];
        std::size_t at = leaving_.size();
        while (at > 0 && chart_.is_steeper(piece, leaving_[at - 1].piece)) --at;
        leaving_.insert(at, make_line(piece));
    }
}

// Returns the index at which a line that begins at `at` is inserted.
std::size_t StripSweep::place_of(std::uint32_t piece, const Place& at) {
    std::size_t p = 1;
    while (p < lines_.size() && chart_.is_above(lines_[p].piece, piece, at)) ++p;
    num_steps_ += p;
    return p;
}

void StripSweep::handle(std::uint32_t e) {
    const StripChart::Event& event = chart_.event(e);
    const auto first_arriving = [&] {
        std::size_t p = 1;
        while (p < lines_.size() && lines_[p].end_event != e) ++p;
        return p;
    };
    if (!event.is_wholly_visible) {
        // no face is near: only the verdicts are updated
        for (std::size_t p = lines_.size(); event.num_arriving > 0 && p-- > 1;) {
            if (lines_[p].end_event == e) hide(p, event.is_above_faces);
        }
        if (event.num_leaving == 0) return;
        collect_leaving(event);
        std::size_t p = place_of(leaving_[0].piece, chart_.place(e));
        for (const Line& line : leaving_) show(p++, line, event.is_above_faces);
        return;
    }
    if (event.num_arriving == 1 && event.num_leaving == 1) {  // the usual event
        const std::size_t p = first_arriving();
        faces_->failed |= p == lines_.size();
        if (!faces_->failed) go_on(p, event.leaving[0], e);
        return;
    }
    collect_leaving(event);
    if (event.num_arriving == 0) {
        turn_at_event(place_of(leaving_[0].piece, chart_.place(e)), 0, e);
        return;
    }
    const std::size_t first = first_arriving();
    for (std::size_t j = 0; j < event.num_arriving; ++j) {
        if (first + j < lines_.size() && lines_[first + j].end_event == e) continue;
        faces_->failed = true;
        return;
    }
    turn_at_event(first, event.num_arriving, e);
}

// Removes line p, which leaves the visible range upwards or downwards, and crosses all lines on its
// way.
void StripSweep::hide(std::size_t p, bool upwards) {
    const Verdict toggles = chart_.toggles(lines_[p].piece);
    lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(p));
    find_meeting(p - 1);
    const std::size_t begin = upwards ? 0 : p;
    const std::size_t end = upwards ? p : lines_.size();
    num_steps_ += 1 + lines_.size() / 4;
    for (std::size_t q = begin; q < end; ++q) set_below(lines_[q], lines_[q].below ^ toggles);
}

void StripSweep::show(std::size_t p, const Line& line, bool from_above) {
    const Verdict toggles = chart_.toggles(line.piece);
    const Verdict around = lines_[p - 1].below;
    lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(p), line);
    find_meeting(p - 1);
    find_meeting(p);
    set_below(lines_[p], from_above ? around : around ^ toggles);
    const std::size_t begin = from_above ? 0 : p + 1;
    const std::size_t end = from_above ? p : lines_.size();
    num_steps_ += 1 + lines_.size() / 4;
    for (std::size_t q = begin; q < end; ++q) set_below(lines_[q], lines_[q].below ^ toggles);
}

}  // namespace atrium::hull
