#include "site_node/refine/membrane.hpp"

#include <algorithm>
#include <cstddef>

namespace atrium::refine {

void Membrane::shrink(std::span<const std::array<std::uint32_t, 3>> triangles,
                      std::span<const float> shares,
                      std::vector<Eigen::Vector3f>& places) {
    constexpr int kNumRounds = 40;
    constexpr float kOverRelaxation = 1.6F;  // best for parts of some twelve edges
    links_.clear();
    // on a closed 2-manifold each neighbour follows a vertex in just one triangle
    for (const auto& triangle : triangles) {
        for (std::size_t k = 0; k < 3; ++k)
            if (shares[triangle[k]] > 0.0F) links_.push_back({triangle[k], triangle[(k + 1) % 3]});
    }
    if (links_.empty()) return;
    std::ranges::sort(links_);
    before_ = places;
    for (int round = 0; round < kNumRounds; ++round) {
        for (std::size_t i = 0; i < links_.size();) {
            const std::uint32_t vertex = links_[i][0];
            Eigen::Vector3f sum = Eigen::Vector3f::Zero();
            float num = 0.0F;
            for (; i < links_.size() && links_[i][0] == vertex; ++i, num += 1.0F)
                sum += places[links_[i][1]];
            places[vertex] += kOverRelaxation * (sum / num - places[vertex]);
        }
    }
    for (std::size_t v = 0; v < places.size(); ++v)
        if (shares[v] > 0.0F) places[v] = before_[v] + shares[v] * (places[v] - before_[v]);
}

}  // namespace atrium::refine
