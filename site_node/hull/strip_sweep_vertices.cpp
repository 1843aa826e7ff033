#include "site_node/hull/strip_sweep.hpp"

#include <algorithm>
#include <utility>

namespace atrium::hull {
namespace {

constexpr VertexKey kBits = 20;
constexpr VertexKey kMask = (VertexKey{1} << kBits) - 1;
constexpr VertexKey kForegroundBit = VertexKey{1} << 62;  // centre in a foreground loop

VertexKey triple_key(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a > b) std::swap(a, b);
    if (b > c) std::swap(b, c);
    if (a > b) std::swap(a, b);
    return (VertexKey{a} << (2 * kBits)) | (VertexKey{b} << kBits) | c;
}

VertexKey ray_key(std::uint32_t ray, std::uint32_t strip) {
    return kRayBit | (VertexKey{ray} << 32) | strip;
}

}  // namespace

void StripSweep::start_corners() {
    triangles_.clear();
    corner_vertices_.clear();
    corners_m_.clear();
    corner_lines_.clear();
    triangulator_.reset(triangles_);
    const Eigen::Vector3d& from = cones_->ray[own_.from];
    const Eigen::Vector3d along = cones_->ray[own_.to] - from;
    const double length = cones_->ray_length[own_.from];
    const double aside = along.dot(from) / length;
    from_ray_ = {length, 0.0};
    to_ray_ = {length + aside, (along - from * (aside / length)).norm()};
}

StripSweep::Corner StripSweep::make_corner(std::uint32_t vertex,
                                           const StripChart::Point& at,
                                           Lines lines) {
    const auto corner = static_cast<std::uint32_t>(corner_vertices_.size());
    corner_vertices_.push_back(vertex);
    corners_m_.emplace_back((from_ray_ + at.phi * (to_ray_ - from_ray_)) / at.u);
    corner_lines_.push_back(lines);
    return {corner, at.phi, at.u};
}

StripSweep::Corner StripSweep::ray_corner(std::uint32_t vertex, double phi, const Line& line) {
    const bool is_centre = line.piece == StripChart::kNone;
    const double u =
        is_centre ? std::numeric_limits<double>::infinity() : chart_.u(line.piece, phi);
    const std::uint32_t own = phi < 0.5 ? kFromRay : kToRay;
    return make_corner(vertex, {phi, u}, {own, is_centre ? kFromRay + kToRay - own : line.strip});
}

void StripSweep::finish_triangles() {
    if (must_stop()) return;
    diagonals_.improve(corners_m_, triangles_, corner_lines_);
    for (const auto& [a, b, c] : triangles_) {
        faces_->triangles.push_back(
            {corner_vertices_[a], corner_vertices_[b], corner_vertices_[c]});
        faces_->num_sides_on_lines += (are_on_one_line(a, b) ? 1u : 0u) +
                                      (are_on_one_line(b, c) ? 1u : 0u) +
                                      (are_on_one_line(c, a) ? 1u : 0u);
    }
}

bool StripSweep::are_on_one_line(std::uint32_t a, std::uint32_t b) const {
    const auto& [a0, a1] = corner_lines_[a];
    const auto& [b0, b1] = corner_lines_[b];
    return (a0 == b0) | (a0 == b1) | (a1 == b0) | (a1 == b1);  // no branch: unpredictable
}

// Ends the edge of `line`, which bounds a face from side `side`, at `vertex`. Seen from outside
// faces lie left of their edges, which is right of them in the chart.
void StripSweep::end_edge(const Line& line, std::uint32_t vertex, Side side) {
    if (side == Side::kTop) {
        faces_->edges.emplace_back(line.edge_start, vertex);
    } else {
        faces_->edges.emplace_back(vertex, line.edge_start);
    }
}

std::uint32_t StripSweep::add_vertex(VertexKey key,
                                     bool may_be_needed,
                                     const Eigen::Vector3d* position) {
    const auto index = static_cast<std::uint32_t>(faces_->vertices.size());
    RunFaces::Vertex& vertex = faces_->vertices.emplace_back();
    vertex.key = key;
    vertex.is_owner = position != nullptr;
    vertex.may_be_needed = may_be_needed;
    if (position != nullptr) vertex.position = *position;
    return index;
}

// Returns the vertex where `line` meets one of the strip's two rays. If the previous strip ended on
// this ray, the vertex exists already.
std::uint32_t StripSweep::ray_vertex(std::uint32_t ray, const Line& line) {
    if (line.piece == StripChart::kNone) return centre_vertex();
    if (line.strip == StripChart::kInfinityStrip) {
        faces_->unbounded = true;
        return 0;
    }
    if (ray == own_.from) {
        num_steps_ += ray_vertices_.size() / 8;
        for (const auto& [strip, vertex] : ray_vertices_) {
            if (strip == line.strip) return vertex;
        }
    }
    const Place& at = ray == own_.from ? StripChart::kStart : StripChart::kEnd;
    const Eigen::Vector3d position = chart_.position(chart_.point(line.piece, at));
    return add_vertex(ray_key(ray, line.strip), true, &position);
}

std::uint32_t StripSweep::centre_vertex() {
    // one vertex per loop: the cones of two loops touch only in their apex
    const auto seen = static_cast<std::uint32_t>(std::popcount(lines_[0].below.seen));
    const bool only_foreground = cones_->min_seen > 0 && seen + 1 == cones_->min_seen &&
                                 own_.kind != SegmentKind::kOutside &&
                                 cones_->views[own_.view].is_partial;
    const VertexKey key = only_foreground ? kCentreBit | kForegroundBit | own_.foreground_loop
                                          : kCentreBit | own_.background_loop;
    return add_vertex(key, true, &cones_->views[own_.view].centre);
}

std::uint32_t StripSweep::triple_vertex(std::uint32_t x,
                                        std::uint32_t y,
                                        const StripChart::Point& at) {
    if (x == StripChart::kInfinityStrip || y == StripChart::kInfinityStrip) {
        faces_->unbounded = true;
        return 0;
    }
    // the bounds may have cut off viewing edges
    const auto is_bounds = [this](std::uint32_t strip) {
        return cones_->views[cones_->strips[strip].view].is_bounds;
    };
    const bool may_be_needed = is_bounds(strip_) || is_bounds(x) || is_bounds(y);
    const bool is_owner = strip_ < x && strip_ < y;
    if (!is_owner) return add_vertex(triple_key(strip_, x, y), may_be_needed, nullptr);
    const Eigen::Vector3d position = chart_.position(at);
    return add_vertex(triple_key(strip_, x, y), may_be_needed, &position);
}

// Adds the vertex where a ray of another camera pierces this strip. The sweep of that camera gives
// it its position.
std::uint32_t StripSweep::event_vertex(const StripChart::Event& event) {
    return add_vertex(ray_key(event.ray, strip_), true, nullptr);
}

}  // namespace atrium::hull
