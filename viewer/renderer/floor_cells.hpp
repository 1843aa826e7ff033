#pragma once

#include "core/geometry/rigid_transform.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::renderer {

/// Which cells of a square of floor around the origin shadows may fall on: the others need none
/// looked up.
class FloorCells {
public:
    static constexpr int kSide = 32;

    explicit FloorCells(double extent_m) : cell_m_(extent_m / kSide) {}

    void clear() { rows_.fill(0); }
    /// What touches this part of the world; what lies beyond the square is left out.
    void add(const Eigen::AlignedBox2d& part_world);
    bool empty() const;
    /// Bounds of all cells that were added, in the world.
    Eigen::AlignedBox2d bounds() const;

    /// What the cells cover of a plane, in whose frame the origin is its middle, as triangles in
    /// the world. They meet without gaps and nowhere cover each other.
    void find_triangles(const Eigen::Vector2d& half_size_m,
                        const geometry::RigidTransform& world_from_plane,
                        std::vector<Eigen::Vector3f>& out) const;

private:
    // `column` and `row` are those of the cell after it
    Eigen::Vector2d corner(int column, int row) const {
        return Eigen::Vector2d(column - kSide / 2, row - kSide / 2) * cell_m_;
    }

    double cell_m_;
    std::array<std::uint32_t, kSide> rows_{};  // a bit per cell
};

}  // namespace atrium::renderer
