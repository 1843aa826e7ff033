#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::refine {

/// Finds points by place. Keeps its memory.
class PointGrid {
public:
    /// The points must be finite. Where they spread over more than some millions of cells, cells
    /// are larger.
    void assign(std::span<const Eigen::Vector3f> points, float cell_m);

    /// Calls `visit(index)` for all points within `radius_m` of `centre`, and for some others
    /// nearby. The order depends on the points only.
    template <typename Visit>
    void near(const Eigen::Vector3f& centre, float radius_m, Visit&& visit) const {
        const Cell low = clamped_cell_of(centre - Eigen::Vector3f::Constant(radius_m));
        const Cell high = clamped_cell_of(centre + Eigen::Vector3f::Constant(radius_m));
        for (int z = low.z; z <= high.z; ++z) {
            for (int y = low.y; y <= high.y; ++y) {
                const std::size_t row = index_of({0, y, z});
                const std::uint32_t end = begins_[row + static_cast<std::size_t>(high.x) + 1];
                for (std::uint32_t i = begins_[row + static_cast<std::size_t>(low.x)]; i < end; ++i)
                    visit(order_[i]);
            }
        }
    }

private:
    struct Cell {
        int x = 0;
        int y = 0;
        int z = 0;
    };

    Cell clamped_cell_of(const Eigen::Vector3f& point) const {
        const auto along = [&](int axis) {
            const float cell = (point[axis] - origin_[axis]) * cells_per_m_;
            return static_cast<int>(std::clamp(
                cell, 0.0F, static_cast<float>(size_[static_cast<std::size_t>(axis)]) - 1.0F));
        };
        return {along(0), along(1), along(2)};
    }
    std::size_t index_of(const Cell& cell) const {
        return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(size_[1]) +
                static_cast<std::size_t>(cell.y)) *
                   static_cast<std::size_t>(size_[0]) +
               static_cast<std::size_t>(cell.x);
    }

    Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();
    float cells_per_m_ = 1.0F;
    std::array<int, 3> size_{1, 1, 1};
    std::vector<std::uint32_t> begins_{0, 0};  // per cell: its first place in `order_`; one more
    std::vector<std::uint32_t> order_;         // points, cell by cell
    std::vector<std::uint32_t> cells_;         // per point
    std::vector<std::uint32_t> next_;          // per cell, while they are filled
};

}  // namespace atrium::refine
