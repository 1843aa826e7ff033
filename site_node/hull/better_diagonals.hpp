#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// Turns the triangulation of planar faces into the constrained Delaunay triangulation by
/// exchanging diagonals (Lawson 1977). Of all triangulations of the same faces without new
/// vertices, it has the largest smallest angle.
///
/// Edges with one triangle are the boundary of the faces and stay. Rounding only affects which
/// diagonals are exchanged: the result always has the same boundary, the same number of triangles
/// and no edge with more than two triangles. Differs from Lawson: an exchange needs a margin of
/// 1e-12 against rounding, and the number of exchanges is limited to 16 per triangle. Reuse one
/// object; it allocates only while it grows. Not thread-safe.
class BetterDiagonals {
public:
    /// The two boundary lines that meet in a corner.
    using Lines = std::array<std::uint32_t, 2>;

    /// Improves `triangles` in place.
    ///
    /// `corners_m`: positions in an orthonormal frame of the plane [m]. `triangles`: indices into
    /// it, all of the same orientation; rounding may have made some of them empty or inverted.
    /// `lines`: empty, or one entry per corner. Two corners on a common line are never joined by a
    /// new diagonal, which would lie along the boundary. If a triangle has a corner twice, an index
    /// is out of range, or the total area is zero, nothing changes.
    void improve(std::span<const Eigen::Vector2d> corners_m,
                 std::span<std::array<std::uint32_t, 3>> triangles,
                 std::span<const Lines> lines = {});

private:
    // Half-edge: 4 * triangle + position of its first corner in the triangle.
    using Edge = std::int32_t;
    static constexpr Edge kNone = -1;

    static Edge next(Edge e) { return (e & 3) == 2 ? e - 2 : e + 1; }
    static Edge before(Edge e) { return (e & 3) == 0 ? e + 2 : e - 1; }
    static Edge in_list_after(Edge e) { return (e & 3) == 2 ? e + 2 : e + 1; }
    std::uint32_t& from(Edge e) { return first_corner_[static_cast<std::size_t>(e)]; }
    std::uint32_t to(Edge e) { return from(next(e)); }

    bool copy(std::span<const std::array<std::uint32_t, 3>> triangles);
    bool find_twins_of_few();
    std::uint8_t& few(std::uint32_t a, std::uint32_t b) { return few_[a * kFewCorners + b]; }
    void find_twins();
    Edge only_edge(std::uint32_t a, std::uint32_t b);
    bool are_joined(std::uint32_t a, std::uint32_t b);
    bool on_one_line(std::uint32_t a, std::uint32_t b) const;
    bool exchange_helps(Edge e);
    void exchange(Edge e);
    void move(Edge e, std::uint32_t corner);

    std::span<const Eigen::Vector2d> corners_m_;
    std::span<const Lines> lines_;
    // few corners: half-edges in a table; otherwise in a list per corner
    static constexpr std::size_t kFewCorners = 32;
    static constexpr std::size_t kFewEdges = 252;
    bool are_few_ = false;
    std::array<std::uint8_t, kFewCorners * kFewCorners> few_{};  // half-edge + 1, by corners
    double orientation_ = 1.0;                                   // -1: the triangles are clockwise
    std::vector<std::uint32_t> first_corner_;  // per half-edge, four entries per triangle
    std::vector<Edge> twin_;                   // per half-edge; kNone on the boundary
    std::vector<Edge> first_at_;               // per corner: a half-edge that leaves it,
    std::vector<Edge> next_at_;                // per half-edge: the next one that leaves its corner
    std::vector<Edge> to_check_;
};

}  // namespace atrium::hull
