#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::hull {

/// Triangulates the faces on one strip during its sweep, as a sweep-line triangulation of monotone
/// polygons, without new vertices.
///
/// A *region* is the part of a face between two neighbouring boundary lines at the sweep line.
/// Faces may be non-convex and may have holes: a region splits where a hole or notch begins and
/// merges where it ends. Coordinates only choose among triangulations; for any rounding the result
/// is closed and has the same number of triangles.
///
/// Chart: phi to the right, u up. Triangles are emitted clockwise in the chart, which is
/// counter-clockwise seen from outside the hull.
class FaceTriangulator {
public:
    enum class Side : std::uint8_t { kTop, kBottom };
    struct Corner {
        std::uint32_t vertex = 0;
        double phi = 0.0;
        double u = 0.0;  // infinite: the camera's centre, straight above every other corner
    };
    using RegionId = std::int32_t;

    /// Starts a strip. Later calls append their triangles to `triangles`, which must outlive them.
    void reset(std::vector<std::array<std::uint32_t, 3>>& triangles);

    /// Opens a region in one vertex, or on the left edge of the strip between two vertices.
    RegionId open(const Corner& v);
    RegionId open(const Corner& top, const Corner& bottom);

    /// Adds the next vertex of the upper or lower boundary of `region`.
    void add(RegionId region, const Corner& v, Side side);

    /// Begins a gap inside `region` at `v`. `region` continues as the part above the gap; the part
    /// below is returned.
    RegionId split(RegionId region, const Corner& v);

    /// Ends the gap between two regions at `v`. `upper` continues as the merged region; `lower` is
    /// no longer valid.
    void merge(RegionId upper, RegionId lower, const Corner& v);

    /// Closes the region in its last vertex `v`.
    void close(RegionId region, const Corner& v);

private:
    // Vertices whose triangles need a later vertex; all but the oldest lie on `side`.
    struct Chain {
        std::int32_t head = -1;  // the newest
        Side side = Side::kTop;
    };
    struct Region {
        Chain chain;
        Chain lower;  // only after a merge: the part below the diagonal to the next vertex
        bool has_lower = false;
    };
    struct Node {
        Corner corner;
        std::int32_t older = -1;
    };

    std::int32_t push(const Corner& v, std::int32_t older);
    void extend(Chain& chain, const Corner& v, Side side);
    void fan(const Chain& chain, const Corner& v);
    void emit(Side side, std::uint32_t older, std::uint32_t newer, std::uint32_t v);

    std::vector<Node> nodes_;
    std::vector<Region> regions_;
    std::vector<std::array<std::uint32_t, 3>>* triangles_ = nullptr;
};

}  // namespace atrium::hull
