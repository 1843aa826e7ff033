#pragma once

#include <cstdint>

/// The arithmetic of colour conversions, row by row: full-range BT.601 in 16 bits. Chroma is right
/// to half a grey level (0.52), luma to 0.6 of one, and grey stays exactly as it is. All sets of
/// instructions give the same bits.
namespace atrium::image {

enum class RowCode : std::uint8_t { kBaseline, kAvx2 };

/// The best one that this processor has.
RowCode best_row_code();

/// Two rows of `width` (even) packed pixels: their luma, and the chroma of the means of their 2x2
/// blocks. Blue comes first, or red.
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
void yuv_of_packed_rows(const PackedRows& in, const YuvRows& out, RowCode code);

/// Two rows of a mosaic, the one with its red samples and the one with its blue ones: the chroma of
/// their 2x2 blocks. `red_x` is the column of red in a block, 0 or 1.
struct MosaicRows {
    const std::uint8_t* red_row;
    const std::uint8_t* blue_row;
    int num_blocks;
    int red_x;
};
void chroma_of_mosaic_rows(const MosaicRows& in, std::uint8_t* u, std::uint8_t* v, RowCode code);

}  // namespace atrium::image
