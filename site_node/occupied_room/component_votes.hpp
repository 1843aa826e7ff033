#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::occupied_room {

/// What a 2x2 block of a segmented picture shows.
enum class BlockState : std::uint8_t {
    kRoom,
    kPerson,
    kGhost,  // the room, where the learned room has a person
};

/// Reusable memory.
struct ComponentScratch {
    std::vector<std::int32_t> labels;  // per pixel
    std::vector<std::int32_t> queue;
    struct Votes {
        std::int32_t picture = 0;
        std::int32_t room = 0;
    };
    std::vector<Votes> votes;  // per component
};

/// Decides for each connected part of the foreground whether it is a person or a ghost, by the
/// votes of its outline. Returns a BlockState per block: foreground if at least two of its four
/// pixels are.
image::Mask judge_components(const image::YuvView& picture,
                             const segmentation::BackgroundStatistics& room,
                             const image::Mask& mask,
                             ComponentScratch& scratch);

/// 4-connected parts of the blocks with a value other than 0.
struct PartLabels {
    std::int32_t num = 0;
    std::vector<std::int32_t> label;  // per block; -1: no part
};
PartLabels label_parts(std::span<const std::uint8_t> blocks, int columns, int rows);

/// Bounds in pixels of the largest 4-connected part of the blocks with a value other than 0.
image::PixelRect largest_part(std::span<const std::uint8_t> blocks, int columns, int rows);

}  // namespace atrium::occupied_room
