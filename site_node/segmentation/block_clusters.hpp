#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::segmentation {

/// Values of one 2x2 block in one picture: four lumas, U, V.
using BlockValue = std::array<std::uint8_t, 6>;

BlockValue block_value(const image::YuvView& picture, int column, int row);

/// The looks of each 2x2 block over pictures of one camera: pictures in which a block looks the
/// same up to noise form one cluster.
struct BlockClusters {
    static constexpr std::size_t kMaxClusters = 6;
    static constexpr std::uint8_t kNoCluster = 255;

    int columns = 0;
    int rows = 0;
    double luma_noise = 0.0;  // standard deviation of one sample [grey levels]
    /// [picture][block]: the cluster, 0 the most frequent; kNoCluster if rare.
    std::vector<std::vector<std::uint8_t>> labels;

    std::size_t num_blocks() const {
        return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    }
};

/// Finds the clusters. Pictures must have one even size. Time is proportional to the number of
/// values.
BlockClusters find_clusters(std::span<const image::YuvView> pictures);

/// Statistics of the room whose blocks look as in cluster `chosen[block]`. The other pictures do
/// not count. A block with kNoCluster has no look: its values are 0 (see fill_unknown).
BackgroundStatistics statistics_of(std::span<const image::YuvView> pictures,
                                   const BlockClusters& clusters,
                                   std::span<const std::uint8_t> chosen);

/// Gives each block with `unknown[block] != 0` the look of the known blocks around it, smoothly.
/// Without any known block everything becomes grey.
void fill_unknown(std::span<const std::uint8_t> unknown, BackgroundStatistics& room);

}  // namespace atrium::segmentation
