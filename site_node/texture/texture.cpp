#include "site_node/texture/texture.hpp"

#include "core/image/block_luma.hpp"
#include "site_node/texture/whole_resolution.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

namespace atrium::texture {
namespace {

using Block = TextureScratch::Block;

constexpr int kBlockSize = 8;  // of JPEG

std::uint64_t load8(const std::uint8_t* bytes) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    return word;
}

// First column in [0, end) with foreground; `end` if there is none.
int first_foreground(const std::uint8_t* row, int end) {
    int x = 0;
    while (x + 8 <= end && load8(row + x) == 0) x += 8;
    while (x < end && row[x] == 0) ++x;
    return x;
}

// One past the last column in [begin, end) with foreground; `begin` if there is none.
int last_foreground(const std::uint8_t* row, int begin, int end) {
    while (end - 8 >= begin && load8(row + end - 8) == 0) end -= 8;
    while (end > begin && row[end - 1] == 0) --end;
    return end;
}

image::PixelRect padded_even(const image::PixelRect& r, int padding_px, int width, int height) {
    const int x0 = std::max(r.x - padding_px, 0) & ~1;
    const int y0 = std::max(r.y - padding_px, 0) & ~1;
    const int x1 = std::min((r.x + r.width + padding_px + 1) & ~1, width & ~1);
    const int y1 = std::min((r.y + r.height + padding_px + 1) & ~1, height & ~1);
    return {x0, y0, x1 - x0, y1 - y0};
}

void set_size(image::Plane& plane, int width, int height) {
    plane.width = width;
    plane.height = height;
    plane.data.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

// `outline` where a block shows both the person and what is behind. Plain C++ that the compiler
// vectorises; each set of instructions is one more instance of it.
#define ATRIUM_INLINE inline __attribute__((always_inline))

ATRIUM_INLINE void vote(const std::uint8_t* __restrict top,
                        const std::uint8_t* __restrict bottom,
                        int num_blocks,
                        std::uint8_t* __restrict alpha,
                        std::uint8_t* __restrict outline) {
    for (int x = 0; x < num_blocks; ++x) {
        const int votes =
            (top[2 * x] & 1) + (top[2 * x + 1] & 1) + (bottom[2 * x] & 1) + (bottom[2 * x + 1] & 1);
        alpha[x] = votes >= 2 ? 255 : 0;
        outline[x] = votes == 2 || votes == 3 ? 255 : 0;
    }
}

void vote_baseline(const std::uint8_t* top,
                   const std::uint8_t* bottom,
                   int num_blocks,
                   std::uint8_t* alpha,
                   std::uint8_t* outline) {
    vote(top, bottom, num_blocks, alpha, outline);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void vote_avx2(const std::uint8_t* top,
                                               const std::uint8_t* bottom,
                                               int num_blocks,
                                               std::uint8_t* alpha,
                                               std::uint8_t* outline) {
    vote(top, bottom, num_blocks, alpha, outline);
}
#endif

#undef ATRIUM_INLINE

// Of the 2x2 block at (x, y), the mean of those pixels that show the person.
std::uint8_t foreground_luma(const image::YuvView& frame, const image::Mask& mask, int x, int y) {
    int sum = 0;
    int num_foreground = 0;
    for (const auto& [px, py] : {std::pair{x, y}, {x + 1, y}, {x, y + 1}, {x + 1, y + 1}}) {
        if (mask.at(px, py) == 0) continue;
        sum += frame.y.at(px, py);
        ++num_foreground;
    }
    return static_cast<std::uint8_t>((sum + num_foreground / 2) / num_foreground);
}

void halve(const image::YuvView& frame,
           const image::Mask& mask,
           const image::PixelRect& crop,
           image::RowCode code,
           TextureScratch& scratch,
           codec::TextureCrop& out) {
    auto* vote_row = vote_baseline;
#if defined(__x86_64__)
    if (code == image::RowCode::kAvx2) vote_row = vote_avx2;
#endif
    const int width = crop.width / 2;
    scratch.outline.resize(static_cast<std::size_t>(width));
    std::uint8_t* outline = scratch.outline.data();
    for (int y = 0; y < crop.height / 2; ++y) {
        std::copy_n(frame.u.row(crop.y / 2 + y) + crop.x / 2, width, out.u.row(y));
        std::copy_n(frame.v.row(crop.y / 2 + y) + crop.x / 2, width, out.v.row(y));
        image::luma_of_blocks(frame, {crop.x, crop.y + 2 * y, width}, code, out.y.row(y));
        vote_row(mask.row(crop.y + 2 * y) + crop.x,
                 mask.row(crop.y + 2 * y + 1) + crop.x,
                 width,
                 out.mask.row(y),
                 outline);
        if (frame.mosaic != image::Mosaic::kNone) continue;
        for (int x = 0; (x += first_foreground(outline + x, width - x)) < width; ++x)
            out.y.row(y)[x] = foreground_luma(frame, mask, crop.x + 2 * x, crop.y + 2 * y);
    }
}

void copy_whole(const image::YuvView& frame,
                const image::Mask& mask,
                const image::PixelRect& crop,
                codec::TextureCrop& out) {
    whole_luma(frame, crop, out.y);
    whole_chroma(frame.u, crop, out.u);
    whole_chroma(frame.v, crop, out.v);
    for (int y = 0; y < crop.height; ++y)
        std::copy_n(mask.row(crop.y + y) + crop.x, crop.width, out.mask.row(y));
}

struct BlockGrid {
    int columns;
    int rows;
};

struct PixelRange {
    int begin;
    int end;
};

PixelRange pixels_of_block(int block, int size) {
    return {block * kBlockSize, std::min((block + 1) * kBlockSize, size)};
}

void sum_foreground(const codec::TextureCrop& picture, BlockGrid grid, std::vector<Block>& blocks) {
    blocks.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows),
                  Block{});
    for (int y = 0; y < picture.height(); ++y) {
        const std::uint8_t* __restrict mask = picture.mask.row(y);
        const std::uint8_t* __restrict planes[3] = {
            picture.y.row(y), picture.u.row(y), picture.v.row(y)};
        for (int column = 0; column < grid.columns; ++column) {
            const PixelRange xs = pixels_of_block(column, picture.width());
            Block& block = blocks[static_cast<std::size_t>(y / kBlockSize * grid.columns + column)];
            std::uint32_t count = 0;
            std::array<std::uint32_t, 3> sum{};
            for (int x = xs.begin; x < xs.end; ++x) {
                count += mask[x] & 1U;
                for (std::size_t p = 0; p < 3; ++p) sum[p] += planes[p][x] & mask[x];
            }
            block.num_foreground += count;
            for (std::size_t p = 0; p < 3; ++p) block.sum[p] += sum[p];
        }
    }
}

void add(Block& total, const Block& block) {
    total.num_foreground += block.num_foreground;
    for (std::size_t p = 0; p < 3; ++p) total.sum[p] += block.sum[p];
}

// The foreground of the block itself, else of the blocks around it, else of the whole picture.
Block source_of_fill(
    const std::vector<Block>& blocks, BlockGrid grid, int column, int row, const Block& whole) {
    const Block& own = blocks[static_cast<std::size_t>(row * grid.columns + column)];
    if (own.num_foreground > 0) return own;
    Block around;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.rows - 1); ++y) {
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.columns - 1); ++x) {
            add(around, blocks[static_cast<std::size_t>(y * grid.columns + x)]);
        }
    }
    return around.num_foreground > 0 ? around : whole;
}

// Eight samples of one row of a block; the compiler makes one register of it.
using Row = std::int16_t __attribute__((vector_size(16)));
using Rows = std::array<Row, kBlockSize>;

// What the pixels next to each one are; those at the edge stand for the ones beyond it.
Row from_left(Row row) { return __builtin_shuffle(row, Row{0, 0, 1, 2, 3, 4, 5, 6}); }
Row from_right(Row row) { return __builtin_shuffle(row, Row{1, 2, 3, 4, 5, 6, 7, 7}); }

// Background becomes the mean of its four neighbours, again and again: from `rows`, in which it has
// the block's mean, towards the smoothest surface through the foreground.
void relax(const Rows& is_foreground, Rows& rows) {
    constexpr int kTimes = 6;  // more of it saves less than 1 % of the bytes
    for (int i = 0; i < kTimes; ++i) {
        const Rows old = rows;
        for (std::size_t y = 0; y < kBlockSize; ++y) {
            const Row above = old[y == 0 ? 0 : y - 1];
            const Row below = old[y + 1 == kBlockSize ? y : y + 1];
            const Row mean = (from_left(old[y]) + from_right(old[y]) + above + below + 2) >> 2;
            rows[y] = (old[y] & is_foreground[y]) | (mean & ~is_foreground[y]);
        }
    }
}

void fill_evenly(image::Plane& plane,
                 const image::Mask& mask,
                 PixelRange xs,
                 PixelRange ys,
                 std::uint8_t value) {
    for (int y = ys.begin; y < ys.end; ++y) {
        std::uint8_t* pixels = plane.row(y);
        const std::uint8_t* own_mask = mask.row(y);
        for (int x = xs.begin; x < xs.end; ++x) pixels[x] = own_mask[x] != 0 ? pixels[x] : value;
    }
}

// Of a whole block, 8 by 8.
void fill_smoothly(image::Plane& plane, int x0, int y0, const Rows& is_foreground) {
    Rows rows;
    for (std::size_t y = 0; y < kBlockSize; ++y) {
        const std::uint8_t* pixels = plane.row(y0 + static_cast<int>(y)) + x0;
        for (int x = 0; x < kBlockSize; ++x) rows[y][x] = pixels[x];
    }
    relax(is_foreground, rows);
    for (std::size_t y = 0; y < kBlockSize; ++y) {
        std::uint8_t* pixels = plane.row(y0 + static_cast<int>(y)) + x0;
        for (int x = 0; x < kBlockSize; ++x) pixels[x] = static_cast<std::uint8_t>(rows[y][x]);
    }
}

Rows foreground_of(const image::Mask& mask, int x0, int y0) {
    Rows rows;
    for (std::size_t y = 0; y < kBlockSize; ++y) {
        const std::uint8_t* pixels = mask.row(y0 + static_cast<int>(y)) + x0;
        for (int x = 0; x < kBlockSize; ++x)
            rows[y][x] = static_cast<std::int16_t>(pixels[x] != 0 ? -1 : 0);
    }
    return rows;
}

void fill_block(codec::TextureCrop& picture,
                PixelRange xs,
                PixelRange ys,
                const Block& source,
                bool has_foreground) {
    // at the right and lower edge the JPEG repeats the last pixels, so that nothing is to be gained
    const bool smooth =
        has_foreground && xs.end - xs.begin == kBlockSize && ys.end - ys.begin == kBlockSize;
    Rows is_foreground;
    if (smooth) is_foreground = foreground_of(picture.mask, xs.begin, ys.begin);
    std::size_t p = 0;
    for (image::Plane* plane : {&picture.y, &picture.u, &picture.v}) {
        const auto mean = static_cast<std::uint8_t>((source.sum[p++] + source.num_foreground / 2) /
                                                    source.num_foreground);
        fill_evenly(*plane, picture.mask, xs, ys, mean);
        if (smooth) fill_smoothly(*plane, xs.begin, ys.begin, is_foreground);
    }
}

void fill_background(codec::TextureCrop& picture, std::vector<Block>& blocks) {
    const BlockGrid grid{(picture.width() + kBlockSize - 1) / kBlockSize,
                         (picture.height() + kBlockSize - 1) / kBlockSize};
    sum_foreground(picture, grid, blocks);
    Block whole;
    for (const Block& block : blocks) add(whole, block);
    if (whole.num_foreground == 0)
        whole = {1, {128, 128, 128}};  // only single pixels, lost by halving
    for (int row = 0; row < grid.rows; ++row) {
        const PixelRange ys = pixels_of_block(row, picture.height());
        for (int column = 0; column < grid.columns; ++column) {
            const PixelRange xs = pixels_of_block(column, picture.width());
            const auto block = static_cast<std::size_t>(row * grid.columns + column);
            const std::uint32_t num_foreground = blocks[block].num_foreground;
            if (num_foreground == kBlockSize * kBlockSize) continue;
            const Block source = source_of_fill(blocks, grid, column, row, whole);
            fill_block(picture, xs, ys, source, num_foreground > 0);
        }
    }
}

}  // namespace

image::PixelRect bounding_rect(const image::Mask& mask) {
    int left = mask.width;
    int right = 0;
    int top = mask.height;
    int bottom = 0;
    for (int y = 0; y < mask.height; ++y) {
        const std::uint8_t* row = mask.row(y);
        const int first = first_foreground(row, mask.width);
        if (first == mask.width) continue;
        left = std::min(left, first);
        right = last_foreground(row, std::max(right, first), mask.width);
        top = std::min(top, y);
        bottom = y + 1;
    }
    if (bottom == 0) return {};
    return {left, top, right - left, bottom - top};
}

bool crop_texture(const image::YuvView& frame,
                  const image::Mask& mask,
                  const image::PixelRect& subject,
                  const TextureOptions& options,
                  TextureScratch& scratch,
                  codec::TextureCrop& out,
                  image::RowCode code) {
    assert((mask.width & ~1) == frame.width() && (mask.height & ~1) == frame.height());
    assert(options.padding_px >= 0);
    if (subject.empty()) return false;
    const image::PixelRect crop =
        padded_even(subject, options.padding_px, frame.width(), frame.height());
    if (crop.empty()) return false;
    out.crop_px = crop;
    const bool is_full =
        options.resolution == Resolution::kFull && crop.width <= kMaxFullPixels / crop.height;
    const int divisor = is_full ? 1 : 2;
    for (image::Plane* plane : {&out.y, &out.u, &out.v, &out.mask})
        set_size(*plane, crop.width / divisor, crop.height / divisor);
    if (is_full)
        copy_whole(frame, mask, crop, out);
    else
        halve(frame, mask, crop, code, scratch, out);
    fill_background(out, scratch.blocks);
    return true;
}

}  // namespace atrium::texture
