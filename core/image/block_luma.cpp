#include "core/image/block_luma.hpp"

namespace atrium::image {
namespace {

// The compiler vectorises these plain loops. Each instruction set is another instance of the same
// source.
#define ATRIUM_INLINE inline __attribute__((always_inline))

ATRIUM_INLINE void mean_of_blocks(const std::uint8_t* __restrict top,
                                  const std::uint8_t* __restrict bottom,
                                  int num_blocks,
                                  std::uint8_t* __restrict out) {
    for (int x = 0; x < num_blocks; ++x) {
        out[x] = static_cast<std::uint8_t>(
            (top[2 * x] + top[2 * x + 1] + bottom[2 * x] + bottom[2 * x + 1] + 2) >> 2);
    }
}

template <int kRedX>
ATRIUM_INLINE void luma_of_mosaic(const std::uint8_t* __restrict red_row,
                                  const std::uint8_t* __restrict blue_row,
                                  int num_blocks,
                                  std::uint8_t* __restrict out) {
    for (int x = 0; x < num_blocks; ++x) {
        out[x] = luma_of_block(red_row[2 * x + kRedX],
                               red_row[2 * x + 1 - kRedX] + blue_row[2 * x + kRedX],
                               blue_row[2 * x + 1 - kRedX]);
    }
}

ATRIUM_INLINE void luma(const YuvView& picture, const BlockRow& blocks, std::uint8_t* out) {
    const std::uint8_t* top = picture.y.row(blocks.y) + blocks.x;
    const std::uint8_t* bottom = picture.y.row(blocks.y + 1) + blocks.x;
    if (picture.mosaic == Mosaic::kNone) return mean_of_blocks(top, bottom, blocks.num_blocks, out);
    const RedAt red = red_at(picture.mosaic);
    const std::uint8_t* red_row = red.y == 0 ? top : bottom;
    const std::uint8_t* blue_row = red.y == 0 ? bottom : top;
    if (red.x == 0) {
        luma_of_mosaic<0>(red_row, blue_row, blocks.num_blocks, out);
    } else {
        luma_of_mosaic<1>(red_row, blue_row, blocks.num_blocks, out);
    }
}

#undef ATRIUM_INLINE

#if defined(__x86_64__)
__attribute__((target("avx2"))) void luma_avx2(const YuvView& picture,
                                               const BlockRow& blocks,
                                               std::uint8_t* out) {
    luma(picture, blocks, out);
}
#endif

}  // namespace

void luma_of_blocks(const YuvView& picture,
                    const BlockRow& blocks,
                    [[maybe_unused]] RowCode code,
                    std::uint8_t* out) {
#if defined(__x86_64__)
    if (code == RowCode::kAvx2) return luma_avx2(picture, blocks, out);
#endif
    luma(picture, blocks, out);
}

}  // namespace atrium::image
