#pragma once

#include "core/codec/texture_codec.hpp"
#include "core/image/colour_rows.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::texture {

/// Foreground of one 8x8 block, the unit of JPEG.
struct FillBlock {
    std::uint32_t num_foreground = 0;
    std::array<std::uint32_t, 3> sum{};  // of Y, U, V over the foreground
};

/// Smooths the background of `picture`: it compresses well and does not shine through at the edge.
/// In a block with foreground the background continues it smoothly. A block without foreground gets
/// the mean of the blocks around it. A block far from all foreground equals the one before it,
/// which JPEG predicts. `blocks` is reusable memory. All instruction sets give the same bits.
void fill_background(codec::TextureCrop& picture,
                     image::RowCode code,
                     std::vector<FillBlock>& blocks);

}  // namespace atrium::texture
