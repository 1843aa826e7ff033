#include "site_node/hull/pencils.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace atrium::hull {
namespace {

struct Frame {
    Eigen::Vector3d e1;
    Eigen::Vector3d e2;
};

// Antipodal directions differ by exactly 2, a full turn is 4; grows with the angle.
double pseudo_angle(const Eigen::Vector2d& v) {
    const double sum = std::abs(v.x()) + std::abs(v.y());
    if (sum == 0.0) return 0.0;
    const double p = v.x() / sum;
    return v.y() < 0.0 ? p - 1.0 : 1.0 - p;
}

void fill_side(const Cones& cones,
               const Cones::View& view,
               const Eigen::Vector3d& baseline,
               const Frame& frame,
               std::vector<std::pair<double, std::uint32_t>>& buffer,
               PencilSide& side) {
    const std::uint32_t n = view.last - view.first;
    side.angle.resize(n);
    side.across.resize(n);
    side.offset.resize(n);
    side.inverse_offset.resize(n);
    side.end_positions.resize(n);
    side.sorted.resize(n);
    side.position.resize(n);
    side.rank.resize(n);
    side.rises.resize(n);
    buffer.clear();
    for (std::uint32_t j = 0; j < n; ++j) {
        const Eigen::Vector3d& ray = cones.ray[view.first + j];
        side.across[j] = {frame.e1.dot(ray), frame.e2.dot(ray)};
        side.angle[j] = pseudo_angle(side.across[j]);
        side.offset[j] = cones.normal[view.first + j].dot(baseline);
        side.inverse_offset[j] = 1.0 / side.offset[j];
        buffer.emplace_back(side.angle[j], j);
    }
    std::sort(buffer.begin(), buffer.end());
    for (std::uint32_t at = 0; at < n; ++at) {
        side.sorted[at] = buffer[at].second;
        side.position[buffer[at].second] = at;
    }
    for (std::uint32_t j = 0; j < n; ++j) {
        const std::uint32_t after = cones.next[view.first + j] - view.first;
        double turn = side.angle[after] - side.angle[j];
        if (turn >= 2.0) turn -= 4.0;
        if (turn < -2.0) turn += 4.0;
        side.rises[j] = turn > 0.0 || (turn == 0.0 && j < after);
        side.end_positions[j] = {side.position[j], side.position[after]};
        if (side.rises[j] == 0) std::swap(side.end_positions[j][0], side.end_positions[j][1]);
    }
}

// Ranks of both sides by one merge; of equal angles the ray of `first` comes first.
void merge_ranks(PencilSide& first, PencilSide& second) {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    const auto na = static_cast<std::uint32_t>(first.sorted.size());
    const auto nb = static_cast<std::uint32_t>(second.sorted.size());
    while (a < na || b < nb) {
        const bool take_first =
            b == nb || (a < na && first.angle[first.sorted[a]] <= second.angle[second.sorted[b]]);
        if (take_first) {
            first.rank[first.sorted[a++]] = b;
        } else {
            second.rank[second.sorted[b++]] = a;
        }
    }
}

}  // namespace

void build_pencils(const Cones& cones, Executor& executor, Pencils& pencils) {
    const std::size_t n = cones.num_views();
    pencils.num_views = n;
    if (pencils.sides.size() < n * n) pencils.sides.resize(n * n);
    if (pencils.sort_buffers.size() < executor.num_workers())
        pencils.sort_buffers.resize(executor.num_workers());
    pencils.pairs.clear();
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t k = i + 1; k < n; ++k) pencils.pairs.emplace_back(i, k);
    }
    const auto build_pair = [&](std::size_t task, std::size_t worker) {
        const auto [i, k] = pencils.pairs[task];
        const Eigen::Vector3d baseline = cones.views[k].centre - cones.views[i].centre;
        const Eigen::Vector3d axis = baseline.normalized();
        const Eigen::Vector3d e1 = axis.unitOrthogonal();
        const Frame frame{e1, axis.cross(e1)};
        auto& buffer = pencils.sort_buffers[worker];
        fill_side(cones, cones.views[i], baseline, frame, buffer, pencils.side(i, k));
        fill_side(cones, cones.views[k], -baseline, frame, buffer, pencils.side(k, i));
        merge_ranks(pencils.side(i, k), pencils.side(k, i));
    };
    executor.parallel_for(pencils.pairs.size(), build_pair);
}

}  // namespace atrium::hull
