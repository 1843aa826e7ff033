#pragma once

#include "core/codec/texture_codec.hpp"
#include "core/image/colour_rows.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::texture {

/// What a block of 8x8 pixels, the unit of JPEG, shows of the person.
struct FillBlock {
    std::uint32_t num_foreground = 0;
    std::array<std::uint32_t, 3> sum{};  // of Y, U, V over the foreground
};

/// Makes the background of `picture` smooth, so that it codes small and none of it shines through
/// at the edge. Within a block the foreground is continued smoothly; a block without any gets the
/// mean of the blocks around it, and one far from all foreground is like the one before it, which
/// is what JPEG foretells. `blocks` is reused memory. All sets of instructions give the same bits.
void fill_background(codec::TextureCrop& picture,
                     image::RowCode code,
                     std::vector<FillBlock>& blocks);

}  // namespace atrium::texture
