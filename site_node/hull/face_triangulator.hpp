#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::hull {

/// Triangulates the faces on one strip while a sweep from left to right finds them, without new
/// vertices.
///
/// A *region* is the part of a face between two neighbouring boundary lines at the sweep's
/// position. Faces may be non-convex and have holes: a region splits where a hole or notch begins
/// and merges where one ends. Decisions by coordinates only choose among triangulations; the result
/// is closed and has as many triangles for any rounding.
///
/// Chart: phi to the right, u up. Triangles are emitted clockwise in the chart, which is
/// counter-clockwise seen from outside the hull.
class FaceTriangulator {
public:
    enum class Side : std::uint8_t { kTop, kBottom };
    struct Corner {
        std::uint32_t vertex = 0;
        double phi = 0.0;
        double u = 0.0;  // infinite: the vertex is straight above everything
    };
    using RegionId = std::int32_t;

    /// Starts with a strip; `triangles` receives what the strip emits.
    void reset(std::vector<std::array<std::uint32_t, 3>>& triangles);

    /// A region that opens in one vertex, or on the left edge of the strip between two.
    RegionId open(const Corner& v);
    RegionId open(const Corner& top, const Corner& bottom);

    /// The next vertex of the region's upper or lower boundary.
    void add(RegionId region, const Corner& v, Side side);

    /// `v` begins a gap inside of the region, which becomes the part above it; the part below is
    /// returned.
    RegionId split(RegionId region, const Corner& v);

    /// `v` ends the gap between two regions; `upper` continues as both.
    void merge(RegionId upper, RegionId lower, const Corner& v);

    /// `v` is the region's last vertex.
    void close(RegionId region, const Corner& v);

private:
    // Vertices that wait for a later one to form triangles with; all but the oldest lie on `side`.
    struct Chain {
        std::int32_t head = -1;  // the newest
        Side side = Side::kTop;
    };
    struct Region {
        Chain chain;
        Chain lower;  // only after a merge: below the diagonal that the next vertex will make
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
