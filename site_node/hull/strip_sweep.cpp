#include "site_node/hull/strip_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace atrium::hull {

void StripSweep::run(const Cones& cones,
                     const Pencils& pencils,
                     const StripRun& run,
                     std::uint64_t max_steps,
                     RunFaces& faces) {
    cones_ = &cones;
    pencils_ = &pencils;
    faces_ = &faces;
    max_steps_ = max_steps;
    view_ = run.view;
    const std::size_t n = cones.num_views();
    full_ = n == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1;
    faces.clear();
    start_lines(run.first);
    for (Line& line : lines_) line.ray_vertex = std::numeric_limits<std::uint32_t>::max();
    strip_ = run.first;
    // the faces on the first strip begin at vertices on its first ray
    for (std::size_t p = 0; p < lines_.size(); ++p) {
        if (!is_full(lines_[p].inside_below)) continue;
        lines_[p].ray_vertex = ray_vertex(run.first, lines_[p].strip, lines_[p].u);
        if (p + 1 < lines_.size())
            lines_[p + 1].ray_vertex = ray_vertex(run.first, lines_[p + 1].strip, lines_[p + 1].u);
    }
    for (std::uint32_t s = 0, strip = run.first; s < run.count; ++s, strip = cones.next[strip]) {
        sweep_strip(strip);
        if (must_stop() || faces.unbounded) return;
    }
}

void StripSweep::sweep_strip(std::uint32_t strip) {
    strip_ = strip;
    phi_ = 0.0;
    collect_events(strip);
    for (std::size_t p = 1; p < lines_.size(); ++p) {
        Line& line = lines_[p];
        line.phi0 = 0.0;
        line.u0 = line.u;
        if (line.strip == kInfinityStrip) {
            line.phi1 = 1.0;
        } else {
            aim(line);
        }
    }
    begin_faces();
    sort_events();
    for (const std::uint32_t e : order_) {
        advance(events_[e].phi);
        if (must_stop()) return;
        handle(events_[e]);
        if (must_stop()) return;
    }
    advance(1.0);
    if (must_stop()) return;
    end_faces();
}

// Only an index is sorted: `aim` needs the events as they were collected.
void StripSweep::sort_events() {
    order_.resize(events_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    faces_->num_steps += events_.size();
    const auto is_before = [this](std::uint32_t l, std::uint32_t r) {
        return events_[l].phi != events_[r].phi ? events_[l].phi < events_[r].phi : l < r;
    };
    constexpr std::size_t kFew = 64;
    if (order_.size() > kFew) {
        std::sort(order_.begin(), order_.end(), is_before);
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

void StripSweep::begin_faces() {
    triangulator_.reset(faces_->triangles);
    for (std::size_t p = 0; p + 1 < lines_.size(); ++p) {
        Line& top = lines_[p];
        if (!is_full(top.inside_below)) continue;
        Line& bottom = lines_[p + 1];
        top.region_below =
            triangulator_.open({top.ray_vertex, 0.0, top.u}, {bottom.ray_vertex, 0.0, bottom.u});
        top.edge_start = top.ray_vertex;
        bottom.edge_start = bottom.ray_vertex;
        faces_->edges.emplace_back(bottom.ray_vertex, top.ray_vertex);
    }
}

void StripSweep::end_faces() {
    const std::uint32_t ray = cones_->next[strip_];
    for (std::size_t p = 0; p < lines_.size(); ++p) {
        Line& top = lines_[p];
        if (!is_full(top.inside_below)) continue;
        if (p + 1 == lines_.size()) {
            faces_->failed = true;
            return;
        }
        Line& bottom = lines_[p + 1];
        bottom.ray_vertex = ray_vertex(ray, bottom.strip, bottom.u);
        if (top.strip != kCentreStrip) {
            top.ray_vertex = ray_vertex(ray, top.strip, top.u);
            triangulator_.add(top.region_below, {top.ray_vertex, 1.0, top.u}, Side::kTop);
            end_edge(top, top.ray_vertex, Side::kTop);
        }
        triangulator_.close(top.region_below, {bottom.ray_vertex, 1.0, bottom.u});
        end_edge(bottom, bottom.ray_vertex, Side::kBottom);
        faces_->edges.emplace_back(top.ray_vertex, bottom.ray_vertex);
    }
}

// Moves all lines on to `phi`.
void StripSweep::advance(double phi) {
    bool in_order = true;
    double above = std::numeric_limits<double>::infinity();
    for (std::size_t p = 1; p < lines_.size(); ++p) {
        Line& line = lines_[p];
        line.u_before = line.u;
        line.u = phi >= line.phi1 ? line.u1 : line.u0 + (phi - line.phi0) * line.slope;
        in_order &= above >= line.u;
        above = line.u;
    }
    faces_->num_steps += lines_.size();
    if (!in_order) resolve_crossings(phi);
    phi_ = phi;
}

// Exchanges neighbours in the order in which they cross between phi_ and `phi`.
void StripSweep::resolve_crossings(double phi) {
    // each pair crosses once: more exchanges than pairs mean numbers that are none
    for (std::size_t budget = lines_.size() * lines_.size(); budget > 0; --budget) {
        std::size_t first = 0;
        double first_share = 2.0;
        for (std::size_t p = 1; p + 1 < lines_.size(); ++p) {
            const double before = lines_[p].u_before - lines_[p + 1].u_before;
            const double now = lines_[p].u - lines_[p + 1].u;
            if (now >= 0.0) continue;
            const double share = before > 0.0 ? before / (before - now) : 0.0;
            if (share < first_share) {
                first_share = share;
                first = p;
            }
        }
        faces_->num_steps += lines_.size();
        if (must_stop()) return;
        if (first == 0) {
            // not a number compares as neither
            for (std::size_t p = 1; p < lines_.size(); ++p)
                faces_->failed |= !std::isfinite(lines_[p].u);
            return;
        }
        const Line& line = lines_[first];
        cross(first,
              phi_ + first_share * (phi - phi_),
              line.u_before + first_share * (line.u - line.u_before));
    }
    faces_->failed = true;
}

// Lines p and p + 1 cross at (phi, u).
void StripSweep::cross(std::size_t p, double phi, double u) {
    const std::uint64_t above = mask_above(p);
    const std::uint64_t between = lines_[p].inside_below;
    const std::uint64_t below = lines_[p + 1].inside_below;
    const std::uint64_t between_after = above ^ (std::uint64_t{1} << lines_[p + 1].view);
    if (is_full(above) || is_full(between) || is_full(below) || is_full(between_after)) {
        if (lines_[p].view == lines_[p + 1].view) {
            faces_->failed = true;  // one silhouette's outline crosses itself: only by rounding
            return;
        }
        const std::uint32_t v = triple_vertex(lines_[p].strip, lines_[p + 1].strip, phi, u);
        const Corner corner{v, phi, u};
        Line& upper = lines_[p];
        Line& lower = lines_[p + 1];
        if (is_full(above)) {
            triangulator_.add(lines_[p - 1].region_below, corner, Side::kBottom);
            end_edge(upper, v, Side::kBottom);
            lower.edge_start = v;
        } else if (is_full(between)) {
            triangulator_.close(upper.region_below, corner);
            end_edge(upper, v, Side::kTop);
            end_edge(lower, v, Side::kBottom);
        } else if (is_full(below)) {
            triangulator_.add(lower.region_below, corner, Side::kTop);
            end_edge(lower, v, Side::kTop);
            upper.region_below = lower.region_below;
            upper.edge_start = v;
        } else {
            lower.region_below = triangulator_.open(corner);
            lower.edge_start = upper.edge_start = v;
        }
    }
    std::swap(lines_[p], lines_[p + 1]);
    lines_[p].inside_below = between_after;
    lines_[p + 1].inside_below = below;
}

void StripSweep::handle(const Event& event) {
    const PencilSide& other = pencils_->side(event.view, view_);
    const std::uint32_t first = cones_->views[event.view].first;
    const std::uint32_t before = cones_->prev[event.ray];
    const std::uint32_t after = event.ray;
    const bool before_arrives = static_cast<bool>(other.rises[before - first]) == event.rising;
    const bool after_leaves = static_cast<bool>(other.rises[after - first]) == event.rising;
    if (before_arrives && after_leaves) {
        pass(find_line(before), after, event);
    } else if (!before_arrives && !after_leaves) {
        pass(find_line(after), before, event);
    } else if (before_arrives) {
        remove_pair(before, after, event);
    } else {
        insert_pair(before, after, event);
    }
}

std::size_t StripSweep::find_line(std::uint32_t strip) const {
    for (std::size_t p = 1; p < lines_.size(); ++p) {
        if (lines_[p].strip == strip) return p;
    }
    return 0;
}

// The line of one strip goes on as that of its neighbour.
void StripSweep::pass(std::size_t p, std::uint32_t strip, const Event& event) {
    if (p == 0) {
        faces_->failed = true;
        return;
    }
    Line& line = lines_[p];
    const bool face_above = is_full(mask_above(p));
    if (face_above || is_full(line.inside_below)) {
        const std::uint32_t v = event_vertex(event);
        const Side side = face_above ? Side::kBottom : Side::kTop;
        triangulator_.add(
            face_above ? lines_[p - 1].region_below : line.region_below, {v, phi_, event.u}, side);
        end_edge(line, v, side);
        line.edge_start = v;
    }
    line.strip = strip;
    line.u = line.u0 = event.u;
    line.phi0 = phi_;
    aim(line);
}

// Two lines begin in one point.
void StripSweep::insert_pair(std::uint32_t strip_a, std::uint32_t strip_b, const Event& event) {
    Line upper;
    upper.strip = strip_a;
    upper.view = event.view;
    upper.phi0 = phi_;
    upper.u = upper.u0 = event.u;
    Line lower = upper;
    lower.strip = strip_b;
    aim(upper);
    aim(lower);
    if (upper.slope < lower.slope) std::swap(upper, lower);

    std::size_t p = 1;
    while (p < lines_.size() && lines_[p].u >= event.u) ++p;
    const std::uint64_t around = mask_above(p);
    upper.inside_below = around ^ (std::uint64_t{1} << event.view);
    lower.inside_below = around;
    if (is_full(around)) {
        const std::uint32_t v = event_vertex(event);
        lower.region_below = triangulator_.split(lines_[p - 1].region_below, {v, phi_, event.u});
        upper.edge_start = lower.edge_start = v;
    } else if (is_full(upper.inside_below)) {
        const std::uint32_t v = event_vertex(event);
        upper.region_below = triangulator_.open({v, phi_, event.u});
        upper.edge_start = lower.edge_start = v;
    }
    const Line pair[] = {upper, lower};
    lines_.insert(
        lines_.begin() + static_cast<std::ptrdiff_t>(p), std::begin(pair), std::end(pair));
}

// Two lines end in one point.
void StripSweep::remove_pair(std::uint32_t strip_a, std::uint32_t strip_b, const Event& event) {
    std::size_t p = find_line(strip_a);
    std::size_t q = find_line(strip_b);
    if (p == 0 || q == 0) {
        faces_->failed = true;
        return;
    }
    if (p > q) std::swap(p, q);
    // rounding may leave another line between the two ends: it crosses one of them just before
    for (; q > p + 1; --q) cross(q - 1, phi_, event.u);
    if (faces_->failed) return;
    const bool face_around = is_full(mask_above(p));
    if (face_around || is_full(lines_[p].inside_below)) {
        const std::uint32_t v = event_vertex(event);
        const Corner corner{v, phi_, event.u};
        if (face_around) {
            triangulator_.merge(lines_[p - 1].region_below, lines_[q].region_below, corner);
        } else {
            triangulator_.close(lines_[p].region_below, corner);
        }
        end_edge(lines_[p], v, face_around ? Side::kBottom : Side::kTop);
        end_edge(lines_[q], v, face_around ? Side::kTop : Side::kBottom);
    }
    lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(p),
                 lines_.begin() + static_cast<std::ptrdiff_t>(q + 1));
}

}  // namespace atrium::hull
