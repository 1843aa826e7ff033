#include "viewer/renderer/drawing/triangle_coverage.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace atrium::renderer {
namespace {

int ceil_within(float value, int size) {
    const float within = std::max(0.0f, std::min(static_cast<float>(size), value));
    const int whole = static_cast<int>(within);
    return whole + (within > static_cast<float>(whole) ? 1 : 0);
}

}  // namespace

void find_covered(std::span<const Eigen::Vector2f> corners_px,
                  std::span<const std::array<std::uint32_t, 3>> triangles,
                  int side_px,
                  CoverageScratch& scratch,
                  std::vector<PixelRun>& out) {
    // half of the grid to which GL snaps corners: adjacent triangles leave no gap
    constexpr float kSlack_px = 1.0f / 512.0f;
    using Corner = CoverageScratch::Corner;
    out.clear();
    Eigen::AlignedBox2i bounds;
    scratch.corners.resize(corners_px.size());
    for (std::size_t i = 0; i < corners_px.size(); ++i) {
        const Eigen::Vector2f& px = corners_px[i];
        const Eigen::Vector2i cell(ceil_within(px.x(), side_px), ceil_within(px.y(), side_px));
        scratch.corners[i] = {px, cell};
        bounds.extend(cell);
    }
    if (bounds.isEmpty() || bounds.min() == bounds.max()) return;
    // one more column on either side, for the slack
    const int left = std::max(bounds.min().x() - 1, 0);
    const int right = std::min(bounds.max().x() + 1, side_px);
    const int top = bounds.min().y();
    const int bottom = bounds.max().y();
    // per pixel: triangles that begin there minus triangles that ended before it
    const auto stride = static_cast<std::size_t>(right - left) + 1;
    scratch.changes.assign(stride * static_cast<std::size_t>(bottom - top), 0);
    for (const auto& [ia, ib, ic] : triangles) {
        const Corner& a = scratch.corners[ia];
        const Corner& b = scratch.corners[ib];
        const Corner& c = scratch.corners[ic];
        // most triangles are smaller than a pixel and contain no pixel centre
        if (a.cell.y() == b.cell.y() && a.cell.y() == c.cell.y()) continue;
        if (a.cell.x() == b.cell.x() && a.cell.x() == c.cell.x()) continue;
        const int end = std::max(std::max(a.cell.y(), b.cell.y()), c.cell.y());
        for (int y = std::min(std::min(a.cell.y(), b.cell.y()), c.cell.y()); y < end; ++y) {
            float low = std::numeric_limits<float>::infinity();
            float high = -low;
            for (const auto& [from, to] :
                 {std::pair(&a, &b), std::pair(&b, &c), std::pair(&c, &a)}) {
                if ((from->cell.y() <= y) == (to->cell.y() <= y)) continue;
                const Eigen::Vector2f way = to->px - from->px;
                const float x =
                    from->px.x() + (static_cast<float>(y) - from->px.y()) * way.x() / way.y();
                low = std::min(low, x);
                high = std::max(high, x);
            }
            const int x0 = std::max(ceil_within(low - kSlack_px, side_px), left);
            const int x1 = std::min(ceil_within(high + kSlack_px, side_px), right);
            if (x0 >= x1) continue;
            std::int32_t* changes =
                scratch.changes.data() + static_cast<std::size_t>(y - top) * stride;
            ++changes[x0 - left];
            --changes[x1 - left];
        }
    }
    for (int y = top; y < bottom; ++y) {
        const std::int32_t* changes =
            scratch.changes.data() + static_cast<std::size_t>(y - top) * stride;
        std::int32_t depth = 0;
        for (int x = left; x <= right; ++x) {
            const std::int32_t before = depth;
            depth += changes[x - left];
            if (before == 0 && depth != 0) out.push_back({y, x, x});
            if (before != 0 && depth == 0) out.back().end = x;
        }
    }
}

}  // namespace atrium::renderer
