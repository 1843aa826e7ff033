#pragma once

#include "core/geometry/rigid_transform.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::renderer {

/// The cells of a square of floor around the origin that may have shadows. The shadow map is
/// sampled only there.
class FloorCells {
public:
    static constexpr int kSide = 32;

    explicit FloorCells(double extent_m) : cell_m_(extent_m / kSide) {}

    void clear() { rows_.fill(0); }
    /// Adds the cells that touch this part of the world. Ignores what lies outside the square.
    void add(const Eigen::AlignedBox2d& part_world);
    bool empty() const;
    /// Bounds of all cells added, in the world.
    Eigen::AlignedBox2d bounds() const;

    /// Writes the part of a rectangle that the cells cover, as triangles in the world.
    /// `world_from_plane` has its origin at the centre of the rectangle. The triangles leave no
    /// gaps and do not overlap.
    void find_triangles(const Eigen::Vector2d& half_size_m,
                        const geometry::RigidTransform& world_from_plane,
                        std::vector<Eigen::Vector3f>& out) const;

private:
    // `column` and `row` are those of the cell after it
    Eigen::Vector2d corner(int column, int row) const {
        return Eigen::Vector2d(column - kSide / 2, row - kSide / 2) * cell_m_;
    }

    double cell_m_;
    std::array<std::uint32_t, kSide> rows_{};  // one bit per cell
};

}  // namespace atrium::renderer
