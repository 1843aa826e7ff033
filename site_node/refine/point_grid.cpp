#include "site_node/refine/point_grid.hpp"

namespace atrium::refine {

void PointGrid::assign(std::span<const Eigen::Vector3f> points, float cell_m) {
    constexpr double kMostCells = 4e6;
    Eigen::Vector3f low = Eigen::Vector3f::Zero();
    Eigen::Vector3f high = Eigen::Vector3f::Zero();
    if (!points.empty()) low = high = points[0];
    for (const Eigen::Vector3f& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    origin_.head<3>() = low;
    const Eigen::Vector3d extent = (high - low).cast<double>();
    double cell = cell_m;
    while (((extent / cell).array() + 1.0).prod() > kMostCells) cell *= 2.0;
    cells_per_m_ = static_cast<float>(1.0 / cell);
    for (int axis = 0; axis < 3; ++axis)
        last_[axis] = static_cast<float>(size_[static_cast<std::size_t>(axis)] =
                                             static_cast<int>(extent[axis] / cell) + 1) -
                      1.0F;
    const std::size_t num_cells = static_cast<std::size_t>(size_[0]) *
                                  static_cast<std::size_t>(size_[1]) *
                                  static_cast<std::size_t>(size_[2]);
    begins_.assign(num_cells + 1, 0);
    cells_.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        cells_[i] = static_cast<std::uint32_t>(index_of(clamped_cell_of(points[i])));
        ++begins_[cells_[i] + 1];
    }
    for (std::size_t c = 0; c < num_cells; ++c) begins_[c + 1] += begins_[c];
    order_.resize(points.size());
    // backwards, so that the points of a cell keep their order
    std::vector<std::uint32_t>& ends = next_;
    ends.assign(begins_.begin() + 1, begins_.end());
    for (std::size_t i = points.size(); i-- > 0;)
        order_[--ends[cells_[i]]] = static_cast<std::uint32_t>(i);
}

}  // namespace atrium::refine
