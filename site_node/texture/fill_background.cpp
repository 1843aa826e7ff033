#include "site_node/texture/fill_background.hpp"

#include <algorithm>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace atrium::texture {
namespace {

constexpr int kBlockSize = 8;  // of JPEG blocks

// Number of steps that replace background by the mean of its four neighbours, from the block's mean
// towards the smoothest surface through the foreground. More steps save less than 1 % of the bytes.
constexpr int kTimes = 6;

struct PixelRange {
    int begin;
    int end;
};

PixelRange pixels_of_block(int block, int size) {
    return {block * kBlockSize, std::min((block + 1) * kBlockSize, size)};
}

struct BlockGrid {
    int columns;
    int rows;
};

// One value for each of the three planes.
using Means = std::array<std::uint8_t, 3>;

std::uint64_t word_at(const std::uint8_t* bytes) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    return word;
}

// Returns the sum of eight bytes.
std::uint32_t sum8(std::uint64_t bytes) {
    constexpr std::uint64_t kEven = 0x00ff00ff00ff00ff;
    const std::uint64_t pairs = (bytes & kEven) + (bytes >> 8 & kEven);
    return static_cast<std::uint32_t>(pairs * 0x0001000100010001 >> 48);
}

// Loads the bytes [x, end) of a row, at most eight, the first one lowest; the rest is 0.
std::uint64_t load_part(const std::uint8_t* row, int x, int end) {
    const int num_missing = kBlockSize - (end - x);
    if (num_missing == 0) return word_at(row + x);
    // together with bytes on the left, if there are any
    if (x >= num_missing) return word_at(row + x - num_missing) >> (8 * num_missing);
    std::uint64_t word = 0;
    std::memcpy(&word, row + x, static_cast<std::size_t>(end - x));
    return word;
}

void sum_foreground(const codec::TextureCrop& picture,
                    PixelRange xs,
                    PixelRange ys,
                    FillBlock& block) {
    for (int y = ys.begin; y < ys.end; ++y) {
        const std::uint64_t mask = load_part(picture.mask.row(y), xs.begin, xs.end);
        if (mask == 0) continue;
        block.num_foreground += sum8(mask & 0x0101010101010101);
        std::size_t p = 0;
        for (const image::Plane* plane : {&picture.y, &picture.u, &picture.v})
            block.sum[p++] += sum8(load_part(plane->row(y), xs.begin, xs.end) & mask);
    }
}

// Layout of a whole 8x8 block: a row of each plane after the other, as long as a register.
constexpr std::size_t kRowBytes = 32;
constexpr std::size_t kPlanes = 3;
using BlockRow = std::array<std::uint8_t, kRowBytes>;

std::size_t byte_of(std::size_t plane, std::size_t x) { return plane * kBlockSize + x; }

unsigned mean_up(unsigned a, unsigned b) { return (a + b + 1) / 2; }

// Rounds two means of two up, and their mean down: nearly no bias in total.
std::uint8_t mean_of(unsigned a, unsigned b, unsigned c, unsigned d) {
    return static_cast<std::uint8_t>((mean_up(a, b) + mean_up(c, d)) / 2);
}

// Portable version of relax_avx2.
void relax(const std::array<std::uint64_t, kBlockSize>& mask,
           const Means& means,
           const std::array<std::uint8_t*, kPlanes>& at,
           std::ptrdiff_t stride) {
    std::array<BlockRow, kBlockSize> rows;
    std::array<BlockRow, kBlockSize> next;
    const auto is_foreground = [&](std::size_t y, std::size_t x) {
        return (mask[y] >> (8 * x) & 1) != 0;
    };
    for (std::size_t y = 0; y < kBlockSize; ++y) {
        for (std::size_t p = 0; p < kPlanes; ++p) {
            const std::uint8_t* const pixels = at[p] + static_cast<std::ptrdiff_t>(y) * stride;
            for (std::size_t x = 0; x < kBlockSize; ++x)
                rows[y][byte_of(p, x)] = is_foreground(y, x) ? pixels[x] : means[p];
        }
    }
    next = rows;
    for (int i = 0; i < kTimes; ++i) {
        for (std::size_t y = 0; y < kBlockSize; ++y) {
            const BlockRow& above = rows[y == 0 ? 0 : y - 1];
            const BlockRow& below = rows[y + 1 == kBlockSize ? y : y + 1];
            for (std::size_t p = 0; p < kPlanes; ++p) {
                for (std::size_t x = 0; x < kBlockSize; ++x) {
                    if (is_foreground(y, x)) continue;
                    const std::size_t left = byte_of(p, x == 0 ? 0 : x - 1);
                    const std::size_t right = byte_of(p, x + 1 == kBlockSize ? x : x + 1);
                    const std::size_t here = byte_of(p, x);
                    next[y][here] =
                        mean_of(rows[y][left], rows[y][right], above[here], below[here]);
                }
            }
        }
        std::swap(rows, next);
    }
    for (std::size_t y = 0; y < kBlockSize; ++y) {
        for (std::size_t p = 0; p < kPlanes; ++p) {
            std::copy_n(rows[y].data() + byte_of(p, 0),
                        kBlockSize,
                        at[p] + static_cast<std::ptrdiff_t>(y) * stride);
        }
    }
}

#if defined(__x86_64__)
#define ATRIUM_AVX2 __attribute__((target("avx2")))

ATRIUM_AVX2 inline __m256i load(const void* bytes) {
    return _mm256_loadu_si256(static_cast<const __m256i*>(bytes));
}

// Like sum_foreground, for four adjacent blocks.
ATRIUM_AVX2 void sum_four_avx2(const codec::TextureCrop& picture,
                               int x,
                               PixelRange ys,
                               FillBlock* blocks) {
    const __m256i zero = _mm256_setzero_si256();
    __m256i num = zero;
    __m256i sum_y = zero;
    __m256i sum_u = zero;
    __m256i sum_v = zero;
    for (int y = ys.begin; y < ys.end; ++y) {
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(y) * picture.mask.width + x;
        const __m256i mask = load(picture.mask.data.data() + at);
        const auto sum_of = [&](const image::Plane& plane) __attribute__((target("avx2"))) {
            return _mm256_sad_epu8(_mm256_and_si256(load(plane.data.data() + at), mask), zero);
        };
        num = _mm256_sub_epi8(num, mask);  // per column a pixel count of at most eight
        sum_y = _mm256_add_epi64(sum_y, sum_of(picture.y));
        sum_u = _mm256_add_epi64(sum_u, sum_of(picture.u));
        sum_v = _mm256_add_epi64(sum_v, sum_of(picture.v));
    }
    std::array<std::array<std::uint64_t, 4>, 4> sums;
    const auto keep =
        [](__m256i value, std::array<std::uint64_t, 4> & out) __attribute__((target("avx2"))) {
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out.data()), value);
    };
    keep(_mm256_sad_epu8(num, zero), sums[0]);
    keep(sum_y, sums[1]);
    keep(sum_u, sums[2]);
    keep(sum_v, sums[3]);
    for (std::size_t i = 0; i < 4; ++i) {
        blocks[i].num_foreground = static_cast<std::uint32_t>(sums[0][i]);
        for (std::size_t p = 0; p < kPlanes; ++p)
            blocks[i].sum[p] = static_cast<std::uint32_t>(sums[p + 1][i]);
    }
}

ATRIUM_AVX2 void relax_avx2(const std::array<std::uint64_t, kBlockSize>& mask,
                            const Means& means,
                            const std::array<std::uint8_t*, kPlanes>& at,
                            std::ptrdiff_t stride) {
    const auto eight = [&means](std::size_t p) {
        return static_cast<long long>(means[p] * std::uint64_t{0x0101010101010101});
    };
    const __m256i mean = _mm256_setr_epi64x(eight(0), eight(1), eight(2), 0);
    // neighbours of each pixel; edge pixels replace those beyond the edge
    const __m256i left = _mm256_broadcastsi128_si256(
        _mm_setr_epi8(0, 0, 1, 2, 3, 4, 5, 6, 8, 8, 9, 10, 11, 12, 13, 14));
    const __m256i right = _mm256_broadcastsi128_si256(
        _mm_setr_epi8(1, 2, 3, 4, 5, 6, 7, 7, 9, 10, 11, 12, 13, 14, 15, 15));
    const __m256i ones = _mm256_set1_epi8(1);
    __m256i is_foreground[kBlockSize];
    __m256i rows[kBlockSize];
    for (std::size_t y = 0; y < kBlockSize; ++y) {
        const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(y) * stride;
        const auto word = [&](std::size_t p) {
            return static_cast<long long>(word_at(at[p] + offset));
        };
        is_foreground[y] = _mm256_set1_epi64x(static_cast<long long>(mask[y]));
        rows[y] = _mm256_blendv_epi8(
            mean, _mm256_setr_epi64x(word(0), word(1), word(2), 0), is_foreground[y]);
    }
    for (int i = 0; i < kTimes; ++i) {
        __m256i above = rows[0];
        for (std::size_t y = 0; y < kBlockSize; ++y) {
            const __m256i here = rows[y];
            const __m256i below = rows[y + 1 == kBlockSize ? y : y + 1];
            const __m256i beside =
                _mm256_avg_epu8(_mm256_shuffle_epi8(here, left), _mm256_shuffle_epi8(here, right));
            const __m256i upright = _mm256_avg_epu8(above, below);
            const __m256i smooth =
                _mm256_sub_epi8(_mm256_avg_epu8(beside, upright),
                                _mm256_and_si256(_mm256_xor_si256(beside, upright), ones));
            rows[y] = _mm256_blendv_epi8(smooth, here, is_foreground[y]);
            above = here;
        }
    }
    for (std::size_t y = 0; y < kBlockSize; ++y) {
        const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(y) * stride;
        const __m128i low = _mm256_castsi256_si128(rows[y]);
        _mm_storel_epi64(reinterpret_cast<__m128i*>(at[0] + offset), low);
        _mm_storel_epi64(reinterpret_cast<__m128i*>(at[1] + offset), _mm_unpackhi_epi64(low, low));
        _mm_storel_epi64(reinterpret_cast<__m128i*>(at[2] + offset),
                         _mm256_extracti128_si256(rows[y], 1));
    }
}
#undef ATRIUM_AVX2
#endif

void sum_foreground(const codec::TextureCrop& picture,
                    BlockGrid grid,
                    [[maybe_unused]] image::RowCode code,
                    std::vector<FillBlock>& blocks) {
    blocks.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows),
                  FillBlock{});
    FillBlock* block = blocks.data();
    for (int row = 0; row < grid.rows; ++row) {
        const PixelRange ys = pixels_of_block(row, picture.height());
        int column = 0;
#if defined(__x86_64__)
        if (code == image::RowCode::kAvx2) {
            for (; (column + 4) * kBlockSize <= picture.width(); column += 4, block += 4)
                sum_four_avx2(picture, column * kBlockSize, ys, block);
        }
#endif
        for (; column < grid.columns; ++column)
            sum_foreground(picture, pixels_of_block(column, picture.width()), ys, *block++);
    }
}

void add(FillBlock& total, const FillBlock& block) {
    total.num_foreground += block.num_foreground;
    for (std::size_t p = 0; p < kPlanes; ++p) total.sum[p] += block.sum[p];
}

FillBlock sum_around(const std::vector<FillBlock>& blocks, BlockGrid grid, int column, int row) {
    FillBlock around;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.rows - 1); ++y) {
        const FillBlock* const blocks_of_row =
            blocks.data() + static_cast<std::ptrdiff_t>(y) * grid.columns;
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.columns - 1); ++x)
            add(around, blocks_of_row[x]);
    }
    return around;
}

Means means_of(const FillBlock& block) {
    Means means;
    for (std::size_t p = 0; p < kPlanes; ++p) {
        means[p] = static_cast<std::uint8_t>((block.sum[p] + block.num_foreground / 2) /
                                             block.num_foreground);
    }
    return means;
}

void fill_evenly(image::Plane& plane,
                 const image::Mask& mask,
                 PixelRange xs,
                 PixelRange ys,
                 std::uint8_t value) {
    const std::uint64_t values = value * std::uint64_t{0x0101010101010101};
    for (int y = ys.begin; y < ys.end; ++y) {
        const std::uint64_t own = load_part(mask.row(y), xs.begin, xs.end);
        const std::uint64_t pixels = load_part(plane.row(y), xs.begin, xs.end);
        const std::uint64_t filled = (pixels & own) | (values & ~own);
        std::memcpy(plane.row(y) + xs.begin, &filled, static_cast<std::size_t>(xs.end - xs.begin));
    }
}

// Fills a block without foreground.
void fill_whole(image::Plane& plane, int x, PixelRange ys, std::uint8_t value) {
    const std::uint64_t values = value * std::uint64_t{0x0101010101010101};
    for (int y = ys.begin; y < ys.end; ++y) std::memcpy(plane.row(y) + x, &values, kBlockSize);
}

void fill_smoothly(codec::TextureCrop& picture,
                   int x,
                   int y,
                   const Means& means,
                   [[maybe_unused]] image::RowCode code) {
    std::array<std::uint64_t, kBlockSize> mask;
    for (int i = 0; i < kBlockSize; ++i)
        mask[static_cast<std::size_t>(i)] = word_at(picture.mask.row(y + i) + x);
    const std::array<std::uint8_t*, kPlanes> at{
        picture.y.row(y) + x, picture.u.row(y) + x, picture.v.row(y) + x};
    auto* relax_block = relax;
#if defined(__x86_64__)
    if (code == image::RowCode::kAvx2) relax_block = relax_avx2;
#endif
    relax_block(mask, means, at, picture.width());
}

}  // namespace

void fill_background(codec::TextureCrop& picture,
                     image::RowCode code,
                     std::vector<FillBlock>& blocks) {
    const BlockGrid grid{(picture.width() + kBlockSize - 1) / kBlockSize,
                         (picture.height() + kBlockSize - 1) / kBlockSize};
    sum_foreground(picture, grid, code, blocks);
    FillBlock whole;
    for (const FillBlock& block : blocks) add(whole, block);
    if (whole.num_foreground == 0)
        whole = {1, {128, 128, 128}};  // only single pixels, which halving removed
    Means means = means_of(whole);
    const std::array<image::Plane*, kPlanes> planes{&picture.y, &picture.u, &picture.v};
    const FillBlock* block = blocks.data();
    for (int row = 0; row < grid.rows; ++row) {
        const PixelRange ys = pixels_of_block(row, picture.height());
        for (int column = 0; column < grid.columns; ++column, ++block) {
            const PixelRange xs = pixels_of_block(column, picture.width());
            const bool is_empty = block->num_foreground == 0;
            const FillBlock source = is_empty ? sum_around(blocks, grid, column, row) : *block;
            if (source.num_foreground > 0) means = means_of(source);
            if (block->num_foreground == kBlockSize * kBlockSize) continue;
            const bool is_wide = xs.end - xs.begin == kBlockSize;
            // at the right and lower edge JPEG repeats the last pixels: smoothness gains nothing
            if (!is_empty && is_wide && ys.end - ys.begin == kBlockSize) {
                fill_smoothly(picture, xs.begin, ys.begin, means, code);
                continue;
            }
            for (std::size_t p = 0; p < kPlanes; ++p) {
                if (is_empty && is_wide)
                    fill_whole(*planes[p], xs.begin, ys, means[p]);
                else
                    fill_evenly(*planes[p], picture.mask, xs, ys, means[p]);
            }
        }
    }
}

}  // namespace atrium::texture
