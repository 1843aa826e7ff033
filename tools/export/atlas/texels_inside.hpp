#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::exporting {

/// Calls `visit(x, y, shares)` for each texel whose centre (x + 0.5, y + 0.5) is in the triangle or
/// less than `margin` texels from its edges. `shares` are the barycentric coordinates of the
/// centre. Texels at negative coordinates are left out. None for a triangle without area.
template <typename Visit>
void for_texels_inside(const std::array<Eigen::Vector2f, 3>& corners, float margin, Visit&& visit) {
    const Eigen::Vector2f ab = corners[1] - corners[0];
    const Eigen::Vector2f ac = corners[2] - corners[0];
    const float twice = ab.x() * ac.y() - ab.y() * ac.x();
    if (!(std::abs(twice) > 1e-7f)) return;
    // gradients of the barycentric coordinates; 1 / length is the height over the opposite edge
    const Eigen::Vector2f grow_b = Eigen::Vector2f(ac.y(), -ac.x()) / twice;
    const Eigen::Vector2f grow_c = Eigen::Vector2f(-ab.y(), ab.x()) / twice;
    const Eigen::Vector2f grow_a = -grow_b - grow_c;
    const float least_a = -margin * grow_a.norm();
    const float least_b = -margin * grow_b.norm();
    const float least_c = -margin * grow_c.norm();
    const auto first = [&](int axis) {
        const float low = std::min({corners[0][axis], corners[1][axis], corners[2][axis]});
        return std::max(0, static_cast<int>(std::ceil(low - margin - 0.5f)));
    };
    const auto last = [&](int axis) {
        const float high = std::max({corners[0][axis], corners[1][axis], corners[2][axis]});
        return static_cast<int>(std::floor(high + margin - 0.5f));
    };
    const int x1 = last(0);
    const int y1 = last(1);
    for (int y = first(1); y <= y1; ++y) {
        for (int x = first(0); x <= x1; ++x) {
            const Eigen::Vector2f offset =
                Eigen::Vector2f(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) -
                corners[0];
            const float b = offset.dot(grow_b);
            const float c = offset.dot(grow_c);
            const float a = 1.0f - b - c;
            if (a < least_a || b < least_b || c < least_c) continue;
            visit(x, y, Eigen::Vector3f(a, b, c));
        }
    }
}

}  // namespace atrium::exporting
