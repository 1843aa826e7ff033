#include "site_node/hull/strip_sweep.hpp"

#include <utility>

namespace atrium::hull {
namespace {

VertexKey key_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a > b) std::swap(a, b);
    if (b > c) std::swap(b, c);
    if (a > b) std::swap(a, b);
    return (static_cast<VertexKey>(a) << 42) | (static_cast<VertexKey>(b) << 21) | c;
}

}  // namespace

// `line` bounds a face from the given side up to `vertex`. Faces lie left of their edges seen from
// outside, which is right of them in the chart.
void StripSweep::end_edge(const Line& line, std::uint32_t vertex, Side side) {
    if (side == Side::kTop) {
        faces_->edges.emplace_back(line.edge_start, vertex);
    } else {
        faces_->edges.emplace_back(vertex, line.edge_start);
    }
}

std::uint32_t StripSweep::add_vertex(VertexKey key,
                                     const Corner& at,
                                     bool is_owner,
                                     bool on_viewing_edge) {
    const auto index = static_cast<std::uint32_t>(faces_->vertices.size());
    RunFaces::Vertex vertex{key, is_owner, on_viewing_edge, Eigen::Vector3d::Zero()};
    if (is_owner) {
        const Eigen::Vector3d& ray0 = cones_->ray[strip_];
        const Eigen::Vector3d& ray1 = cones_->ray[cones_->next[strip_]];
        vertex.position = cones_->views[view_].centre + (ray0 + at.phi * (ray1 - ray0)) / at.u;
    }
    faces_->vertices.push_back(vertex);
    return index;
}

std::uint32_t StripSweep::ray_vertex(std::uint32_t ray, std::uint32_t strip, double u) {
    if (strip == kCentreStrip) return centre_vertex();
    if (strip == kInfinityStrip) {
        faces_->unbounded = true;
        return 0;
    }
    const auto index = static_cast<std::uint32_t>(faces_->vertices.size());
    RunFaces::Vertex vertex{
        key_of(cones_->prev[ray], ray, strip), true, true, Eigen::Vector3d::Zero()};
    vertex.position = cones_->views[view_].centre + cones_->ray[ray] / u;
    faces_->vertices.push_back(vertex);
    return index;
}

std::uint32_t StripSweep::centre_vertex() {
    // one per contour: the cones of two contours only touch in their apex
    const auto index = static_cast<std::uint32_t>(faces_->vertices.size());
    const VertexKey key = (VertexKey{1} << 63) | cones_->contour[strip_];
    faces_->vertices.push_back({key, true, true, cones_->views[view_].centre});
    return index;
}

std::uint32_t StripSweep::triple_vertex(std::uint32_t x, std::uint32_t y, double phi, double u) {
    if (x == kInfinityStrip || y == kInfinityStrip) {
        faces_->unbounded = true;
        return 0;
    }
    return add_vertex(key_of(strip_, x, y), {0, phi, u}, strip_ < x && strip_ < y, false);
}

// A ray of another camera ends here; that camera's own sweep places it.
std::uint32_t StripSweep::event_vertex(const Event& event) {
    return add_vertex(
        key_of(strip_, cones_->prev[event.ray], event.ray), {0, event.phi, event.u}, false, true);
}

}  // namespace atrium::hull
