#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace atrium::geometry {

/// An axis-aligned box around displacements [m].
struct DisplacementBox {
    Eigen::Array3d low = Eigen::Array3d::Zero();
    Eigen::Array3d high = Eigen::Array3d::Zero();

    static DisplacementBox none() {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        return {Eigen::Array3d::Constant(kInfinity), Eigen::Array3d::Constant(-kInfinity)};
    }
    void add(const Eigen::Array3d& displacement) {
        low = low.min(displacement);
        high = high.max(displacement);
    }
    void add(const DisplacementBox& other) {
        low = low.min(other.low);
        high = high.max(other.high);
    }
    /// Length of the longest displacement in the box [m].
    double longest_m() const { return low.abs().max(high.abs()).matrix().norm(); }
};

/// Maps the triangles around a collapsing vertex onto those that remain, and bounds the
/// displacement of every point.
///
/// Let u be the vertex and w_0 ... w_(k-1) its neighbours, counter-clockwise. The star of triangles
/// T_i = (u, w_i, w_(i+1)) becomes the fan S_i = (w_0, w_i, w_(i+1)), i = 1 ... k-2. The map is
/// continuous and piecewise linear:
/// - u maps to the nearest point q of the fan, in some S_j. The border w_0 ... w_(k-1) maps to
///   itself.
/// - The segment from u to w_i maps to a path in the fan, from q through S_j ... to w_i. The path
///   crosses the edges w_0 w_l in order, each at the point nearest to the segment that keeps the
///   order along the segment.
/// - This cuts each T_i into triangles and quadrilaterals whose corners all map to the same S_l.
///   S_l is convex: each piece maps to it linearly (quadrilaterals in two halves), and adjacent
///   pieces agree on their common side.
/// A linear piece has its largest displacement at a corner. A box around the displacements of the
/// corners thus holds for all points. Unlike in Cohen, Manocha, Olano, "Simplifying Polygonal
/// Models Using Successive Mappings" (1997), the map need not be one-to-one and needs no common
/// projection to a plane: it keeps the border of the star, and every such map of a disc covers the
/// whole fan.
class CollapseMap {
public:
    static constexpr std::size_t kMaxRing = 24;

    /// Computes the boxes of the fan; returns true if no displacement in them exceeds `max_m`.
    /// `after()` then has the boxes of S_1 ... S_(k-2). `ring`: w_0 ... w_(k-1), 3 to kMaxRing of
    /// them. `before`: per T_i the box of the points mapped to it so far. `rounding_m`: largest
    /// rounding error of one displacement.
    bool bound(const Eigen::Vector3d& u,
               std::span<const Eigen::Vector3d> ring,
               std::span<const DisplacementBox> before,
               double max_m,
               double rounding_m);

    std::span<const DisplacementBox> after() const { return {after_.data() + 1, ring_.size() - 2}; }

private:
    void find_nearest(const Eigen::Vector3d& u);
    void cross_edges(const Eigen::Vector3d& u, std::size_t spoke);
    void map_triangle(std::size_t i, const DisplacementBox& before);

    std::span<const Eigen::Vector3d> ring_;
    std::size_t nearest_ = 1;  // j
    Eigen::Array3d at_u_;      // q - u
    // [i][l]: displacement where the segment from u to w_i crosses the edge w_0 w_l
    std::array<std::array<Eigen::Array3d, kMaxRing>, kMaxRing + 1> crossing_;
    std::array<DisplacementBox, kMaxRing> after_;
};

}  // namespace atrium::geometry
