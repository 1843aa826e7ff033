#include "world_server/physics/surfel_grid.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

constexpr float kCellM = 0.04F;    // about two spacings of surfels: a handful in each cell
constexpr float kMaxCells = 3e5F;  // surfels that are far apart get larger cells, not more

}  // namespace

void SurfelGrid::fit_cells(std::span<const PlacedSurfel> surfels) {
    low_ = high_ = surfels.front().position;
    float max_speed_sq = 0.0F;
    for (const PlacedSurfel& surfel : surfels) {
        low_ = low_.cwiseMin(surfel.position);
        high_ = high_.cwiseMax(surfel.position);
        max_speed_sq = std::max(max_speed_sq, surfel.velocity.squaredNorm());
    }
    max_speed_mps_ = std::sqrt(max_speed_sq);
    float cell_m = kCellM;
    const Eigen::Array3f size = (high_ - low_).array();
    while (((size / cell_m).floor() + 1.0F).prod() > kMaxCells) cell_m *= 1.5F;
    inverse_cell_ = 1.0F / cell_m;
    dims_ = cell_of(high_) + 1;
}

void SurfelGrid::assign(std::span<const PlacedSurfel> surfels) {
    surfels_.resize(surfels.size());
    max_speed_mps_ = 0.0F;
    if (surfels.empty()) return;
    fit_cells(surfels);

    octants_near_.assign(static_cast<std::size_t>(dims_.prod()), 0);
    // counting sort
    cell_begin_.assign(static_cast<std::size_t>(dims_.prod()) + 1, 0);
    cell_of_surfel_.resize(surfels.size());
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        const Eigen::Array3i cell = cell_of(surfels[i].position);
        const std::size_t index = cell_index(cell.x(), cell.y(), cell.z());
        cell_of_surfel_[i] = static_cast<std::uint32_t>(index);
        ++cell_begin_[index + 1];
        octants_near_[index] |= octant_of(surfels[i].normal);
    }
    for (std::size_t i = 1; i < cell_begin_.size(); ++i) cell_begin_[i] += cell_begin_[i - 1];
    // backwards, each cell's end counts down to its begin
    for (std::size_t i = surfels.size(); i-- > 0;) {
        surfels_[--cell_begin_[cell_of_surfel_[i] + 1]] = surfels[i];
    }
    // entry c + 1 now holds the begin of cell c: move all down by one
    std::copy(cell_begin_.begin() + 1, cell_begin_.end(), cell_begin_.begin());
    cell_begin_.back() = static_cast<std::uint32_t>(surfels.size());
    spread_octants();
}

// By one cell each way, one axis after the other.
void SurfelGrid::spread_octants() {
    static_assert(kOctantReachM <= kCellM);
    const auto num = static_cast<std::ptrdiff_t>(octants_near_.size());
    for (const std::ptrdiff_t step : {1, dims_.x(), dims_.x() * dims_.y()}) {
        spreading_ = octants_near_;
        // beyond the end of a row it goes on at the next: a cell more is no harm
        for (std::ptrdiff_t i = step; i < num; ++i) {
            octants_near_[static_cast<std::size_t>(i)] |=
                spreading_[static_cast<std::size_t>(i - step)];
            octants_near_[static_cast<std::size_t>(i - step)] |=
                spreading_[static_cast<std::size_t>(i)];
        }
    }
}

}  // namespace atrium::physics
