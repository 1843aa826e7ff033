#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::geometry {

/// The motion of the part of a surface in one cell of a lattice.
struct MotionCell {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();    // [m] mean of the surface in the cell
    Eigen::Vector3f velocity = Eigen::Vector3f::Zero();  // [m/s] at the centre
    Eigen::Vector3f turn = Eigen::Vector3f::Zero();      // [rad/s] rotation about the centre
    /// Share of the pictures' evidence that the motion explains, 0 to 1. Low where nothing was seen
    /// and where the motion is probably wrong.
    float confidence = 0.0F;

    Eigen::Vector3f velocity_at(const Eigen::Vector3f& position) const {
        return velocity + turn.cross(position - centre);
    }
};

/// The velocity of one place of a surface.
struct FoundMotion {
    Eigen::Vector3f velocity = Eigen::Vector3f::Zero();  // [m/s]
    float confidence = 0.0F;                             // 0: unknown
};

/// Finds the velocity of places on a surface from its cells: that of the nearest cell, blended with
/// cells around it that move alike.
class MotionField {
public:
    /// `cell_m`: the spacing of the lattice, positive. Copies the cells; their values are finite.
    void assign(std::span<const MotionCell> cells, float cell_m);

    bool empty() const { return cells_.empty(); }
    std::span<const MotionCell> cells() const { return cells_; }
    float cell_m() const { return cell_m_; }

    /// Confidence 0 further than two cells from any centre. O(cells within a layer of the lattice).
    FoundMotion at(const Eigen::Vector3f& position) const;

private:
    std::vector<MotionCell> cells_;  // ordered by the height of their centres
    float cell_m_ = 0.1F;
};

}  // namespace atrium::geometry
