#include "world_server/physics/rigid/flat_area.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::physics {
namespace {

constexpr btScalar kNoAreaM2 = btScalar(1e-8);
constexpr std::array<Corner, 4> kExtentDirections{{{1, 1}, {-1, 1}, {1, 0}, {0, 1}}};

// Cuts away the part to the right of the edge.
void cut(Polygon& polygon, const Corner& from, const Corner& to) {
    std::array<btScalar, Polygon::kMaxCorners> left;  // twice the area of the corner with the edge
    bool is_all_left = true;
    for (std::size_t i = 0; i < polygon.size; ++i) {
        const Corner& c = polygon.corners[i];
        left[i] = (to.u - from.u) * (c.v - from.v) - (to.v - from.v) * (c.u - from.u);
        is_all_left = is_all_left && left[i] >= -kNoAreaM2;
    }
    if (is_all_left) return;
    Polygon rest;
    for (std::size_t i = 0; i < polygon.size; ++i) {
        const std::size_t next = i + 1 < polygon.size ? i + 1 : 0;
        const Corner& a = polygon.corners[i];
        const Corner& b = polygon.corners[next];
        if (left[i] >= 0) rest.add(a);
        if ((left[i] < 0) != (left[next] < 0)) {
            const btScalar t = left[i] / (left[i] - left[next]);
            rest.add({a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)});
        }
    }
    polygon = rest;
}

}  // namespace

Polygon circle(const Corner& centre, btScalar radius) {
    static const std::array<Corner, kNumRim> directions = [] {
        std::array<Corner, kNumRim> all;
        for (std::size_t i = 0; i < kNumRim; ++i) {
            const double angle = (0.25 + 2.0 * static_cast<double>(i) / kNumRim) * std::numbers::pi;
            all[i] = {btScalar(std::cos(angle)), btScalar(std::sin(angle))};
        }
        return all;
    }();
    Polygon rim;
    for (const Corner& d : directions) rim.add({centre.u + radius * d.u, centre.v + radius * d.v});
    return rim;
}

Polygon shared_area(Polygon area, const Polygon& outline) {
    for (std::size_t i = 0; i < outline.size && area.size > 0; ++i) {
        cut(area, outline.corners[i], outline.corners[i + 1 < outline.size ? i + 1 : 0]);
    }
    return area;
}

FlatArea::FlatArea(const PlaneFrame& face, const PlaneFrame& end)
    : face_(face), end_(end), facing_(-face.normal.dot(end.normal)) {}

btScalar FlatArea::gap_at(const Corner& c) const {
    return (face_.at(c) - end_.origin).dot(end_.normal) / facing_;
}

void FlatArea::add(const Polygon& polygon) {
    if (polygon.size < 3) return;
    is_empty_ = false;
    for (std::size_t i = 0; i < polygon.size; ++i) {
        const Corner& c = polygon.corners[i];
        const Place place{c, gap_at(c)};
        if (place.gap < deepest_.gap) deepest_ = place;
        for (std::size_t d = 0; d < kExtentDirections.size(); ++d) {
            const btScalar along = kExtentDirections[d].u * c.u + kExtentDirections[d].v * c.v;
            Extent& extent = extents_[d];
            if (along < extent.low) {
                extent.low = along;
                extent.at_low = place;
            }
            if (along > extent.high) {
                extent.high = along;
                extent.at_high = place;
            }
        }
    }
}

std::optional<FlatTouch> FlatArea::touch(btScalar reach_m,
                                         btScalar min_width_m,
                                         const FlatContactOptions& options) const {
    if (is_empty_ || deepest_.gap > reach_m) return std::nullopt;
    btScalar width = BT_LARGE_FLOAT;
    for (std::size_t d = 0; d < extents_.size(); ++d) {
        const btScalar length = d < 2 ? SIMDSQRT12 : btScalar(1);
        width = std::min(width, length * (extents_[d].high - extents_[d].low));
    }
    if (width < min_width_m || -2 * deepest_.gap > width) return std::nullopt;
    std::array<Place, 4> places{
        extents_[0].at_high, extents_[1].at_high, extents_[0].at_low, extents_[1].at_low};
    const auto lowest = std::min_element(
        places.begin(), places.end(), [](const auto& a, const auto& b) { return a.gap < b.gap; });
    // it tips about this one
    if (deepest_.gap < lowest->gap - options.deeper_m) *lowest = deepest_;
    FlatTouch touch{.normal = face_.normal, .points = {}};
    for (std::size_t i = 0; i < places.size(); ++i)
        touch.points[i] = {face_.at(places[i].corner), places[i].gap};
    return touch;
}

}  // namespace atrium::physics
