#include "viewer/renderer/backdrop/floor_cells.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>

namespace atrium::renderer {
namespace {

// Clips off the part of a convex polygon where sign * p[axis] exceeds `limit`.
void clip(std::vector<Eigen::Vector2d>& polygon,
          Eigen::Index axis,
          double sign,
          double limit,
          std::vector<Eigen::Vector2d>& scratch) {
    scratch.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Eigen::Vector2d& from = polygon[i];
        const Eigen::Vector2d& to = polygon[(i + 1) % polygon.size()];
        const double from_inside = limit - sign * from[axis];
        const double to_inside = limit - sign * to[axis];
        if (from_inside >= 0.0) scratch.push_back(from);
        if ((from_inside >= 0.0) != (to_inside >= 0.0))
            scratch.push_back(from + (to - from) * (from_inside / (from_inside - to_inside)));
    }
    std::swap(polygon, scratch);
}

}  // namespace

void FloorCells::add(const Eigen::AlignedBox2d& part_world) {
    if (part_world.isEmpty()) return;
    const auto cell_of = [this](double m) {
        return static_cast<int>(std::floor(std::clamp(m / cell_m_ + kSide / 2, -1.0, kSide + 1.0)));
    };
    const int left = std::max(cell_of(part_world.min().x()), 0);
    const int right = std::min(cell_of(part_world.max().x()), kSide - 1);
    const int top = std::max(cell_of(part_world.min().y()), 0);
    const int bottom = std::min(cell_of(part_world.max().y()), kSide - 1);
    if (left > right) return;
    const std::uint32_t cells = (~std::uint32_t{0} >> (kSide - 1 - (right - left))) << left;
    for (int row = top; row <= bottom; ++row) rows_[static_cast<std::size_t>(row)] |= cells;
}

bool FloorCells::empty() const {
    return std::ranges::all_of(rows_, [](std::uint32_t row) { return row == 0; });
}

Eigen::AlignedBox2d FloorCells::bounds() const {
    Eigen::AlignedBox2d bounds;
    for (int row = 0; row < kSide; ++row) {
        const std::uint32_t cells = rows_[static_cast<std::size_t>(row)];
        if (cells == 0) continue;
        bounds.extend(corner(std::countr_zero(cells), row));
        bounds.extend(corner(kSide - std::countl_zero(cells), row + 1));
    }
    return bounds;
}

// Does not merge cells: where a corner of one rectangle lies on an edge of another, rounding would
// leave out pixels or draw them twice.
void FloorCells::find_triangles(const Eigen::Vector2d& half_size_m,
                                const geometry::RigidTransform& world_from_plane,
                                std::vector<Eigen::Vector3f>& out) const {
    out.clear();
    const geometry::RigidTransform plane_from_world = world_from_plane.inverse();
    const double height_m = world_from_plane.translation.z();
    const auto in_plane = [&](int column, int row) -> Eigen::Vector2d {
        const Eigen::Vector2d p = corner(column, row);
        return (plane_from_world * Eigen::Vector3d(p.x(), p.y(), height_m)).head<2>();
    };
    std::vector<Eigen::Vector2d> polygon;
    std::vector<Eigen::Vector2d> scratch;
    for (int row = 0; row < kSide; ++row) {
        for (std::uint32_t cells = rows_[static_cast<std::size_t>(row)]; cells != 0;
             cells &= cells - 1) {
            const int column = std::countr_zero(cells);
            polygon = {in_plane(column, row),
                       in_plane(column + 1, row),
                       in_plane(column + 1, row + 1),
                       in_plane(column, row + 1)};
            for (const Eigen::Index axis : {0, 1})
                for (const double sign : {-1.0, 1.0})
                    clip(polygon, axis, sign, half_size_m[axis], scratch);
            for (std::size_t i = 2; i < polygon.size(); ++i) {
                for (const std::size_t at : {std::size_t{0}, i - 1, i}) {
                    const Eigen::Vector3d p(polygon[at].x(), polygon[at].y(), 0.0);
                    out.emplace_back((world_from_plane * p).cast<float>());
                }
            }
        }
    }
}

}  // namespace atrium::renderer
