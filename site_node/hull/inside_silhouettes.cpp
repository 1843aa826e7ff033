#include "site_node/hull/inside_silhouettes.hpp"

#include <algorithm>
#include <limits>

namespace atrium::hull {

std::size_t InsideSilhouettes::Polygons::row_of(double y) const {
    const double row = (y - first_y) * rows_per_px;
    return row > 0.0 ? std::min(static_cast<std::size_t>(row), kNumRows - 1) : 0;
}

void InsideSilhouettes::Polygons::assign(std::span<const std::vector<Eigen::Vector2d>> polygons) {
    segments.clear();
    double last_y = -std::numeric_limits<double>::infinity();
    first_y = std::numeric_limits<double>::infinity();
    for (const std::vector<Eigen::Vector2d>& polygon : polygons) {
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            segments.push_back({polygon[i], polygon[(i + 1) % polygon.size()]});
            first_y = std::min(first_y, polygon[i].y());
            last_y = std::max(last_y, polygon[i].y());
        }
    }
    rows_per_px = last_y > first_y ? kNumRows / (last_y - first_y) : 0.0;
    row_begin.assign(kNumRows + 1, 0);
    const auto for_each_row = [&](const Segment& segment, const auto& visit) {
        const auto [low, high] = std::minmax(segment.from.y(), segment.to.y());
        for (std::size_t row = row_of(low); row <= row_of(high); ++row) visit(row);
    };
    for (const Segment& segment : segments)
        for_each_row(segment, [&](std::size_t row) { ++row_begin[row + 1]; });
    for (std::size_t row = 0; row < kNumRows; ++row) row_begin[row + 1] += row_begin[row];
    crossing.resize(row_begin[kNumRows]);
    for (std::uint32_t i = 0; i < segments.size(); ++i)
        for_each_row(segments[i], [&](std::size_t row) { crossing[row_begin[row]++] = i; });
    // each row's begin is at its end now
    for (std::size_t row = kNumRows; row > 0; --row) row_begin[row] = row_begin[row - 1];
    row_begin[0] = 0;
}

bool InsideSilhouettes::Polygons::contains(const Eigen::Vector2d& point_px) const {
    bool is_inside = false;
    const std::size_t row = row_of(point_px.y());
    for (std::uint32_t i = row_begin[row]; i < row_begin[row + 1]; ++i) {
        const auto& [from, to] = segments[crossing[i]];
        if ((from.y() > point_px.y()) == (to.y() > point_px.y())) continue;
        const double share = (point_px.y() - from.y()) / (to.y() - from.y());
        if (from.x() + share * (to.x() - from.x()) > point_px.x()) is_inside = !is_inside;
    }
    return is_inside;
}

void InsideSilhouettes::assign(std::span<const SilhouetteView* const> views) {
    num_views_ = 0;
    for (const SilhouetteView* view : views) {
        if (view == nullptr) continue;
        if (num_views_ == views_.size()) views_.emplace_back();
        View& copy = views_[num_views_++];
        copy.intrinsics = view->intrinsics;
        copy.rotation = view->camera_from_site.rotation.toRotationMatrix();
        copy.translation = view->camera_from_site.translation;
        copy.contours.assign(view->contours);
        copy.field.segments.clear();
        if (!view->field.empty()) copy.field.assign({&view->field, 1});
    }
}

bool InsideSilhouettes::contains(const Eigen::Vector3d& point_site) const {
    for (std::size_t i = 0; i < num_views_; ++i) {
        const View& view = views_[i];
        const Eigen::Vector3d p = view.rotation * point_site + view.translation;
        const geometry::PinholeCamera& lens = view.intrinsics;
        const double x = p.x() / p.z();
        const double y = p.y() / p.z();
        const Eigen::Vector2d at(lens.fx * x + lens.skew * y + lens.cx, lens.fy * y + lens.cy);
        const bool is_seen =
            p.z() > 0.0 && (view.field.segments.empty() || view.field.contains(at));
        if (is_seen && !view.contours.contains(at)) return false;
        if (!is_seen && view.field.segments.empty()) return false;
    }
    return true;
}

}  // namespace atrium::hull
