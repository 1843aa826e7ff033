#pragma once

#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/block_clusters.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::occupied_room {

/// Finds people who never left their place, as somebody on a chair: hardly a block of their outline
/// has a lasting look, since nobody sits quite still, and what they enclose has an edge all around.
/// Looks only where people can be. Returns 1 per such block of `room`, which shows look
/// `chosen[block]`, else 0.
std::vector<std::uint8_t> find_never_empty(const segmentation::BlockClusters& clusters,
                                           std::span<const std::uint8_t> chosen,
                                           const segmentation::BackgroundStatistics& room,
                                           const image::Mask& where_people_can_be);

}  // namespace atrium::occupied_room
