#pragma once

#include <Eigen/Core>

#include <array>
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

    /// The points cell by cell, in an order in which those of a row of cells follow each other.
    std::span<const std::uint32_t> order() const { return order_; }

    /// Calls `visit(begin, end)` with ranges of places in `order()`. They hold all points within
    /// `radius_m` of `centre`, and some others nearby, none twice.
    template <typename Visit>
    void near(const Eigen::Vector3f& centre, float radius_m, Visit&& visit) const {
        const Cell low = clamped_cell_of(centre.array() - radius_m);
        const Cell high = clamped_cell_of(centre.array() + radius_m);
        for (int z = low.z(); z <= high.z(); ++z) {
            for (int y = low.y(); y <= high.y(); ++y) {
                const std::size_t row = index_of({0, y, z, 0});
                const std::uint32_t begin = begins_[row + static_cast<std::size_t>(low.x())];
                const std::uint32_t end = begins_[row + static_cast<std::size_t>(high.x()) + 1];
                if (begin != end) visit(begin, end);
            }
        }
    }

private:
    using Cell = Eigen::Array4i;  // the last is 0

    Cell clamped_cell_of(const Eigen::Array3f& point) const {
        const Eigen::Array4f at(point.x(), point.y(), point.z(), 0.0F);
        return ((at - origin_) * cells_per_m_).max(0.0F).min(last_).cast<int>();
    }
    std::size_t index_of(const Cell& cell) const {
        return (static_cast<std::size_t>(cell.z()) * static_cast<std::size_t>(size_[1]) +
                static_cast<std::size_t>(cell.y())) *
                   static_cast<std::size_t>(size_[0]) +
               static_cast<std::size_t>(cell.x());
    }

    Eigen::Array4f origin_ = Eigen::Array4f::Zero();
    Eigen::Array4f last_ = Eigen::Array4f::Zero();  // cell
    float cells_per_m_ = 1.0F;
    std::array<int, 3> size_{1, 1, 1};
    std::vector<std::uint32_t> begins_{0, 0};  // per cell: its first place in `order_`; one more
    std::vector<std::uint32_t> order_;
    std::vector<std::uint32_t> cells_;  // per point
    std::vector<std::uint32_t> next_;   // per cell, while they are filled
};

}  // namespace atrium::refine
