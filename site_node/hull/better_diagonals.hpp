#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// Makes the triangles of planar faces less thin by exchanging diagonals, until the triangulation
/// is the constrained Delaunay one (Lawson 1977): of all triangulations of the same faces without
/// new vertices it has the largest smallest angle.
///
/// Edges with one triangle are the faces' boundary and stay. Numbers only decide whether a diagonal
/// is exchanged: for any rounding the result has the same boundary, the same number of triangles
/// and no edge with more than two of them. Reuse one object; it allocates only while it grows.
class BetterDiagonals {
public:
    /// The two lines in the plane, other than through the faces, that meet in a corner.
    using Lines = std::array<std::uint32_t, 2>;

    /// `corners_m`: positions in an orthonormal frame of the plane [m]; `triangles`: indices into
    /// it, all with the same orientation, changed in place. `lines`, if not empty: one per corner;
    /// corners of the same line are never joined by a new diagonal, since it could only lie along
    /// the boundary. Triangles may be empty or turned over by rounding. Triangles with a corner
    /// twice, or without any area together, are left as they are.
    void improve(std::span<const Eigen::Vector2d> corners_m,
                 std::span<std::array<std::uint32_t, 3>> triangles,
                 std::span<const Lines> lines = {});

private:
    // An edge of a triangle is 4 * triangle + the place of its first corner.
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
    // edges of few corners are in a table, others are listed by corner
    static constexpr std::size_t kFewCorners = 32;
    static constexpr std::size_t kFewEdges = 252;
    bool are_few_ = false;
    std::array<std::uint8_t, kFewCorners * kFewCorners> few_{};  // edge + 1, by its two corners
    double orientation_ = 1.0;                                   // -1: the triangles are clockwise
    std::vector<std::uint32_t> first_corner_;  // per edge: the triangles, four entries for each
    std::vector<Edge> twin_;                   // per edge; kNone on the boundary
    std::vector<Edge> first_at_;               // per corner: one edge from it,
    std::vector<Edge> next_at_;                // per edge: another one from the same corner
    std::vector<Edge> to_check_;
};

}  // namespace atrium::hull
