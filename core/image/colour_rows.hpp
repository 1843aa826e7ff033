#pragma once

#include <cstdint>

/// Converts colours row by row: full-range BT.601 with 16-bit arithmetic. Largest errors: chroma
/// 0.52 grey levels, luma 0.6; grey is exact. All instruction sets give the same bits.
namespace atrium::image {

enum class RowCode : std::uint8_t { kBaseline, kAvx2 };

/// Returns the best variant that this processor supports.
RowCode best_row_code();

/// Two rows of `width` (even) packed pixels, BGR or RGB.
struct PackedRows {
    const std::uint8_t* top;
    const std::uint8_t* bottom;
    int width;
    bool blue_first;
};
struct YuvRows {
    std::uint8_t* top_luma;
    std::uint8_t* bottom_luma;
    std::uint8_t* u;
    std::uint8_t* v;
};
/// Computes the luma of each pixel and the chroma of the mean of each 2x2 block.
void yuv_of_packed_rows(const PackedRows& in, const YuvRows& out, RowCode code);

/// Two rows of a mosaic, one with its red and one with its blue samples. `red_x` is the column of
/// red in a block, 0 or 1.
struct MosaicRows {
    const std::uint8_t* red_row;
    const std::uint8_t* blue_row;
    int num_blocks;
    int red_x;
};
/// Computes the chroma of each 2x2 block.
void chroma_of_mosaic_rows(const MosaicRows& in, std::uint8_t* u, std::uint8_t* v, RowCode code);

}  // namespace atrium::image
