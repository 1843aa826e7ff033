#pragma once

#include "core/image/colour_rows.hpp"
#include "core/image/image.hpp"

namespace atrium::image {

/// A row of adjacent 2x2 blocks. The top left pixel of the first is (x, y), both even.
struct BlockRow {
    int x = 0;
    int y = 0;
    int num_blocks = 0;
};

/// Computes one luma value per block: luma_of_block for a mosaic, else the rounded mean of four.
/// The blocks lie within the picture. All instruction sets give the same bits.
void luma_of_blocks(const YuvView& picture,
                    const BlockRow& blocks,
                    RowCode code,
                    std::uint8_t* out);

}  // namespace atrium::image
