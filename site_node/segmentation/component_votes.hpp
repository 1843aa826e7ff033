#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::segmentation {

/// One connected part of the foreground, and where its outline has edges (outline_votes.hpp).
struct ComponentVotes {
    std::int32_t size = 0;     // pixels
    std::int32_t picture = 0;  // votes for an edge in the picture: a person or thing
    std::int32_t room = 0;     // votes for an edge in the learned room: a ghost
    std::int64_t sum_x = 0;    // of the pixels
    std::int64_t sum_y = 0;
};

/// Reusable memory.
struct ComponentScratch {
    std::vector<std::int32_t> label;  // per pixel: index of its part; -1: background
    std::vector<std::int32_t> queue;
    std::vector<ComponentVotes> components;
};

/// Finds the 4-connected parts of `mask` and counts the votes of their outlines. Results are in
/// `scratch`.
void count_votes(const image::YuvView& picture,
                 const BackgroundStatistics& room,
                 const image::Mask& mask,
                 ComponentScratch& scratch);

/// Whether nearly all votes are for the learned room. A person votes nearly always for the picture,
/// also before a patterned wall. Parts without a clear majority are things that were moved a
/// little.
bool is_clear_ghost(const ComponentVotes& votes);

/// Whether so many pixels of `mask` may be a person.
bool has_size_of_person(std::int32_t num_pixels, const image::Mask& mask);

/// What a 2x2 block of a segmented picture shows.
enum class BlockState : std::uint8_t {
    kRoom,
    kPerson,
    kGhost,  // the room, where the learned room has a person
};

/// Decides for each part whether it is a person or a ghost. Returns a BlockState per block:
/// foreground if at least two of its four pixels are.
image::Mask judge_components(const image::YuvView& picture,
                             const BackgroundStatistics& room,
                             const image::Mask& mask,
                             ComponentScratch& scratch);

/// 4-connected parts of cells with a value other than 0.
struct PartLabels {
    std::int32_t num = 0;
    std::vector<std::int32_t> label;  // per cell; -1: no part
};
PartLabels label_parts(std::span<const std::uint8_t> cells, int columns, int rows);

/// Bounds in pixels of the largest 4-connected part of the 2x2 blocks with a value other than 0.
image::PixelRect largest_part(std::span<const std::uint8_t> blocks, int columns, int rows);

}  // namespace atrium::segmentation
