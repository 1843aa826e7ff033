#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>
#include "site_node/hull/outlines.hpp"
namespace atrium::hull {
enum class SegmentKind : std::uint8_t { kSilhouette, kOutside, kUnseen };
struct LabelledOutlines {
    std::vector<Eigen::Vector2d> points;
    struct Segment { std::uint32_t from, to; SegmentKind kind; std::uint32_t foreground_loop, background_loop; };
    std::vector<Segment> segments;
    std::vector<std::uint32_t> chain_ends;
    void clear() { points.clear(); segments.clear(); chain_ends.clear(); }
};
inline void label_whole(const Outlines& o, LabelledOutlines& out) {
    out.clear();
    out.points = o.points;
    for (std::uint32_t c = 0; c < o.num_contours(); ++c) {
        const auto b = o.begin_of(c), n = o.ends[c] - b;
        for (std::uint32_t i = 0; i < n; ++i) out.segments.push_back({b + i, b + (i + 1) % n, SegmentKind::kSilhouette, c, c});
        out.chain_ends.push_back(o.ends[c]);
    }
}
}
