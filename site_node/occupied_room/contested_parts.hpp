#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/block_clusters.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::occupied_room {

/// Where two looks of a block are frequent, one may be a person who stood there for long. Decides
/// which, for whole parts of the picture: neighbouring blocks belong to one part if they change
/// their looks in the same pictures. The person is the look with an edge all around the part; the
/// room continues beyond.
///
/// Returns the look of the room per block: 0, the most frequent one, except in parts where that is
/// the person; there 1, the second, or kNoCluster if the block has no second one.
std::vector<std::uint8_t> decide_contested(std::span<const image::YuvView> pictures,
                                           const segmentation::BlockClusters& clusters);

}  // namespace atrium::occupied_room
