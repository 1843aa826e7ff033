#pragma once

#include "world_server/physics/people/float4.hpp"
#include "world_server/physics/people/moving_surfel.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::physics {

/// A surfel at one instant. World frame.
struct PlacedSurfel {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;    // unit length, outward
    Eigen::Vector3f velocity;  // [m/s]
};

/// Surfels sorted into cells. Rebuilt every tick in memory that is reused. Deterministic.
class SurfelGrid {
public:
    /// Places the surfels with `share_to_go` of their motion remaining and scales their velocities
    /// by `share_of_velocity`. All values must be finite. Widely spread surfels get cells larger
    /// than `cell_m`.
    void assign(std::span<const MovingSurfel> surfels,
                float share_to_go,
                float share_of_velocity,
                float cell_m);

    bool empty() const { return surfels_.empty(); }
    std::span<const PlacedSurfel> surfels() const { return surfels_; }  // ordered by cell
    const Eigen::Vector3f& low() const { return low_; }                 // bounds of the surfels
    const Eigen::Vector3f& high() const { return high_; }
    bool is_near(const Eigen::Vector3f& low, const Eigen::Vector3f& high) const {
        return !empty() && (high.array() >= low_.array()).all() &&
               (low.array() <= high_.array()).all();
    }

    /// Returns the octants of the normals of all surfels within a cell size of a point, and perhaps
    /// of some surfels further away.
    std::uint8_t octants_near(const Eigen::Vector3f& p) const {
        if (empty()) return 0;
        const Eigen::Array3i cell = cell_of(p);
        if ((cell < -1).any() || (cell > dims_).any()) return 0;
        const Eigen::Array3i within = cell.max(0).min(dims_ - 1);
        return octants_near_[cell_index(within.x(), within.y(), within.z())];
    }

    /// Calls `visit(surfel)` for all surfels in the cells that the box touches. Some of them lie
    /// outside the box.
    template <typename Visit>
    void visit_box(const Eigen::Vector3f& low,
                   const Eigen::Vector3f& high,
                   const Visit& visit) const {
        if (!is_near(low, high)) return;
        const Eigen::Array3i from = cell_of(low).max(0);
        const Eigen::Array3i to = cell_of(high).min(dims_ - 1);
        for (int z = from.z(); z <= to.z(); ++z) {
            for (int y = from.y(); y <= to.y(); ++y) {
                const std::size_t begin = cell_begin_[cell_index(from.x(), y, z)];
                const std::size_t end = cell_begin_[cell_index(to.x(), y, z) + 1];
                for (std::size_t i = begin; i < end; ++i) visit(surfels_[i]);
            }
        }
    }

    /// Calls `visit(surfel)` for all surfels within `radius_m` of a point, limited to the cells
    /// that the box of half size `reach_m` around it touches. Same order as `visit_box`. Some
    /// surfels lie further away.
    template <typename Visit>
    void visit_ball(const Eigen::Vector3f& centre,
                    float radius_m,
                    float reach_m,
                    const Visit& visit) const {
        const Eigen::Vector3f reach = Eigen::Vector3f::Constant(reach_m);
        const Eigen::Vector3f low = centre - reach;
        const Eigen::Vector3f high = centre + reach;
        if (!is_near(low, high)) return;
        const Eigen::Array3i from = cell_of(low).max(0);
        const Eigen::Array3i to = cell_of(high).min(dims_ - 1);
        const Eigen::Array3f at = ((centre - low_) * inverse_cell_).array();  // in cells
        const float radius = radius_m * inverse_cell_ + kCellSlack;
        for (int z = from.z(); z <= to.z(); ++z) {
            const float left_sq = radius * radius - square(beside_cell(at.z(), z));
            for (int y = from.y(); y <= to.y(); ++y) {
                const float half_sq = left_sq - square(beside_cell(at.y(), y));
                if (half_sq <= 0.0F) continue;
                const float half = std::sqrt(half_sq);
                const int begin_x = std::max(from.x(), static_cast<int>(at.x() - half));
                const int end_x = std::min(to.x(), static_cast<int>(at.x() + half));
                if (begin_x > end_x) continue;
                const std::size_t begin = cell_begin_[cell_index(begin_x, y, z)];
                const std::size_t end = cell_begin_[cell_index(end_x, y, z) + 1];
                for (std::size_t i = begin; i < end; ++i) visit(surfels_[i]);
            }
        }
    }

private:
    static constexpr float kCellSlack = 1e-3F;  // in cells, for rounding
    static float square(float x) { return x * x; }
    // Distance of a coordinate from the nearer side of a cell, in cells; 0 inside it.
    static float beside_cell(float at, int cell) {
        const auto side = static_cast<float>(cell);
        return std::max({0.0F, side - at, at - side - 1.0F});
    }
    Eigen::Array3i cell_of(const Eigen::Vector3f& p) const {
        return ((p - low_) * inverse_cell_).array().floor().cast<int>();
    }
    std::size_t cell_index(int x, int y, int z) const {
        return static_cast<std::size_t>((z * dims_.y() + y) * dims_.x() + x);
    }
    void place(std::span<const MovingSurfel> surfels, float share_to_go);
    void fit_cells(float cell_m);
    void spread_octants();

    std::vector<PlacedSurfel> surfels_;
    std::vector<std::uint32_t> cell_begin_;  // surfels of cell i: [cell_begin_[i], [i + 1])
    std::vector<Float4> places_;  // positions in input order; the fourth lane is undefined
    std::vector<std::uint32_t> cell_of_surfel_;
    std::vector<std::uint8_t> octants_near_;  // octants of the normals in a cell and its neighbours
    std::vector<std::uint8_t> spreading_;
    Eigen::Array3i dims_ = Eigen::Array3i::Zero();
    Eigen::Vector3f low_ = Eigen::Vector3f::Zero();
    Eigen::Vector3f high_ = Eigen::Vector3f::Zero();
    float inverse_cell_ = 1.0F;  // [1/m]
};

}  // namespace atrium::physics
