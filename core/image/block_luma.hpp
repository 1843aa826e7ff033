#pragma once

#include "core/image/colour_rows.hpp"
#include "core/image/image.hpp"

namespace atrium::image {

/// 2x2 blocks side by side; the first one's upper left pixel is (x, y), both even.
struct BlockRow {
    int x = 0;
    int y = 0;
    int num_blocks = 0;
};

/// One value of luma per block: of a mosaic luma_of_block, else the mean of four, rounded. The
/// blocks lie in the picture. All sets of instructions give the same bits.
void luma_of_blocks(const YuvView& picture,
                    const BlockRow& blocks,
                    RowCode code,
                    std::uint8_t* out);

}  // namespace atrium::image
