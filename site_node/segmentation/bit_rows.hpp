#pragma once

#include "core/image/sparse_mask.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::segmentation {

/// Part of a mask with one bit per pixel: whole words of 64 columns, the leftmost pixel lowest.
/// Each row has a word more on either side, and there is a row more above and below. Beyond the
/// edge of the picture these repeat its pixels.
struct BitRows {
    int width = 0;  // of the whole mask
    int first_row = 0;
    int num_rows = 0;
    int first_word = 0;
    int num_words = 0;
    std::vector<std::uint64_t> words;

    int end_row() const { return first_row + num_rows; }
    std::size_t stride() const { return static_cast<std::size_t>(num_words) + 2; }
    /// First word of row `y`, first_row - 1 to end_row().
    std::uint64_t* row(int y) {
        return words.data() + static_cast<std::size_t>(y - first_row + 1) * stride() + 1;
    }
    const std::uint64_t* row(int y) const {
        return words.data() + static_cast<std::size_t>(y - first_row + 1) * stride() + 1;
    }
    /// The 4 x kLines pixels from (x, y) on, row by row, the first lowest. `x` and `y` are
    /// multiples of four. Where they begin beside the rows: 0. Below the last row that one is
    /// repeated.
    template <int kLines>
    unsigned tile(int y, int x) const {
        const auto word = static_cast<unsigned>(x / 64 - first_word);
        const auto line = static_cast<unsigned>(y - first_row);
        if (line >= static_cast<unsigned>(num_rows) || word >= static_cast<unsigned>(num_words))
            return 0;
        const std::uint64_t* const first = row(y) + word;
        unsigned bits = 0;
        for (int i = 0; i < kLines; ++i) {
            const auto lines =
                static_cast<std::size_t>(std::min(i, num_rows - static_cast<int>(line)));
            bits |= (static_cast<unsigned>(first[lines * stride()] >> (x % 64)) & 15u) << (4 * i);
        }
        return bits;
    }
    /// Takes rows and columns of another one, with other content.
    void shape_like(const BitRows& other);
    /// Sets what lies beyond the edges. Required after writing to the rows.
    void repeat_edges();
};

/// Packs the rows with foreground and all within `margin` of them, a multiple of four, from a row
/// that is a multiple of four. False, if there is no foreground.
bool pack(const image::SparseMask& mask, int margin, BitRows& out);

/// Pixels whose four neighbours are all set as well, and pixels that are set or have a neighbour
/// that is. `out` is another object.
void erode(const BitRows& in, BitRows& out);
void dilate(const BitRows& in, BitRows& out);

/// The majority (5 of 9) of each pixel's 3x3 neighbourhood where `where` is set, else the pixel.
void majority(const BitRows& in, const BitRows& where, BitRows& out);

}  // namespace atrium::segmentation
