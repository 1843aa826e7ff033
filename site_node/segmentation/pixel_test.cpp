#include "site_node/segmentation/pixel_test.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace atrium::segmentation {
namespace {

// Deviations of chroma, in quarters, are cut here: far beyond any threshold, and what follows fits
// 16 bits.
constexpr int kMaxDeviation = 1023;

// Two rows of pixels, and the row of blocks that they are.
struct BlockRow {
    const std::uint8_t* top;
    const std::uint8_t* bottom;
    const std::uint8_t* u;
    const std::uint8_t* v;
    const std::uint8_t* top_low;
    const std::uint8_t* top_high;
    const std::uint8_t* bottom_low;
    const std::uint8_t* bottom_high;
    const std::int16_t* ratio_u;
    const std::int16_t* ratio_v;
    const std::int16_t* whiten_u;
    const std::int16_t* whiten_uv;
    const std::int16_t* whiten_v;
    std::uint8_t* top_out;
    std::uint8_t* bottom_out;
};

struct Limits {
    std::int32_t max_distance_sq;
    std::int16_t min_colour_luma;
    std::int16_t inverse_gain;
};

// Rounded product with a factor in 1/32768.
std::int16_t scaled(std::int16_t value, std::int16_t factor) {
    return static_cast<std::int16_t>((static_cast<std::int32_t>(value) * factor + (1 << 14)) >> 15);
}

std::int16_t deviation(int chroma, std::int16_t luma, std::int16_t ratio) {
    // in quarters: the sum of four lumas, times 8, times a ratio in 1/4096
    const int quarters = 4 * (chroma - 128) - scaled(luma, ratio);
    // in 1/64
    return static_cast<std::int16_t>(std::clamp(quarters, -kMaxDeviation, kMaxDeviation) * 16);
}

// No branches, here and below: so the compiler vectorises the loops with what every processor has.
std::uint8_t has_other_hue(const BlockRow& row, int x, const Limits& limits) {
    const int at = 2 * x;
    const int sum = row.top[at] + row.top[at + 1] + row.bottom[at] + row.bottom[at + 1];
    const int brightest = std::max(std::max(row.top[at], row.top[at + 1]),
                                   std::max(row.bottom[at], row.bottom[at + 1]));
    const auto luma = static_cast<std::int16_t>(8 * sum);
    const std::int16_t du = deviation(row.u[x], luma, row.ratio_u[x]);
    const std::int16_t dv = deviation(row.v[x], luma, row.ratio_v[x]);
    const std::int32_t a = scaled(du, row.whiten_u[x]);
    const std::int32_t b = scaled(du, row.whiten_uv[x]) + scaled(dv, row.whiten_v[x]);
    const int has_hue = (sum >= limits.min_colour_luma) & (brightest < kClipped);
    return static_cast<std::uint8_t>(-(has_hue & (a * a + b * b > limits.max_distance_sq)));
}

// Of one row of pixels; `hue` is that of their blocks, 255 or 0.
void test_pixels(const std::uint8_t* __restrict y,
                 const std::uint8_t* __restrict low,
                 const std::uint8_t* __restrict high,
                 const std::uint8_t* __restrict hue,
                 int num_pixels,
                 std::int16_t inverse_gain,
                 std::uint8_t* __restrict out) {
    for (int x = 0; x < num_pixels; ++x) {
        const int compensated =
            (scaled(static_cast<std::int16_t>(64 * y[x]), inverse_gain) + 16) >> 5;
        const int luma = std::min(compensated, 255);
        const int outside = (luma < low[x]) | (luma > high[x]);
        out[x] = static_cast<std::uint8_t>(-outside | hue[x]);
    }
}

void test_row(const BlockRow& row, int first, int num_blocks, const Limits& limits) {
    constexpr int kChunk = 128;  // blocks
    std::array<std::uint8_t, kChunk> hue;
    std::array<std::uint8_t, 2 * kChunk> hue_of_pixels;
    for (; first < num_blocks; first += kChunk) {
        const int num = std::min(kChunk, num_blocks - first);
        for (int x = 0; x < num; ++x)
            hue[static_cast<std::size_t>(x)] = has_other_hue(row, first + x, limits);
        for (int x = 0; x < num; ++x) {
            const auto block = static_cast<std::size_t>(x);
            hue_of_pixels[2 * block] = hue_of_pixels[2 * block + 1] = hue[block];
        }
        const int at = 2 * first;
        const std::int16_t gain = limits.inverse_gain;
        const std::uint8_t* const hues = hue_of_pixels.data();
        test_pixels(row.top + at,
                    row.top_low + at,
                    row.top_high + at,
                    hues,
                    2 * num,
                    gain,
                    row.top_out + at);
        test_pixels(row.bottom + at,
                    row.bottom_low + at,
                    row.bottom_high + at,
                    hues,
                    2 * num,
                    gain,
                    row.bottom_out + at);
    }
}

#if defined(__x86_64__)
#define ATRIUM_AVX2 __attribute__((target("avx2")))

ATRIUM_AVX2 inline __m256i load(const void* bytes) {
    return _mm256_loadu_si256(static_cast<const __m256i*>(bytes));
}

ATRIUM_AVX2 inline __m256i load_chroma(const std::uint8_t* bytes) {
    const __m256i wide =
        _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes)));
    return _mm256_slli_epi16(_mm256_sub_epi16(wide, _mm256_set1_epi16(128)), 2);
}

ATRIUM_AVX2 inline __m256i deviation(__m256i chroma, __m256i luma, const std::int16_t* ratio) {
    const __m256i quarters = _mm256_sub_epi16(chroma, _mm256_mulhrs_epi16(luma, load(ratio)));
    const __m256i cut =
        _mm256_min_epi16(_mm256_max_epi16(quarters, _mm256_set1_epi16(-kMaxDeviation)),
                         _mm256_set1_epi16(kMaxDeviation));
    return _mm256_slli_epi16(cut, 4);
}

// Of 16 blocks: both bytes of a block are 255 or 0, as its two columns of pixels need them.
ATRIUM_AVX2 inline __m256i have_other_hue(
    __m256i top, __m256i bottom, const BlockRow& row, int x, const Limits& limits) {
    const __m256i ones = _mm256_set1_epi8(1);
    const __m256i sum =
        _mm256_add_epi16(_mm256_maddubs_epi16(top, ones), _mm256_maddubs_epi16(bottom, ones));
    const __m256i brightest = _mm256_max_epu8(top, bottom);
    const __m256i not_clipped = _mm256_cmpeq_epi16(
        _mm256_subs_epu8(brightest, _mm256_set1_epi8(static_cast<char>(kClipped - 1))),
        _mm256_setzero_si256());
    const __m256i dark = _mm256_cmpgt_epi16(_mm256_set1_epi16(limits.min_colour_luma), sum);
    const __m256i luma = _mm256_slli_epi16(sum, 3);
    const __m256i du = deviation(load_chroma(row.u + x), luma, row.ratio_u + x);
    const __m256i dv = deviation(load_chroma(row.v + x), luma, row.ratio_v + x);
    const __m256i a = _mm256_mulhrs_epi16(du, load(row.whiten_u + x));
    const __m256i b = _mm256_add_epi16(_mm256_mulhrs_epi16(du, load(row.whiten_uv + x)),
                                       _mm256_mulhrs_epi16(dv, load(row.whiten_v + x)));
    const __m256i low = _mm256_unpacklo_epi16(a, b);
    const __m256i high = _mm256_unpackhi_epi16(a, b);
    const __m256i max = _mm256_set1_epi32(limits.max_distance_sq);
    const __m256i far = _mm256_packs_epi32(_mm256_cmpgt_epi32(_mm256_madd_epi16(low, low), max),
                                           _mm256_cmpgt_epi32(_mm256_madd_epi16(high, high), max));
    return _mm256_and_si256(_mm256_andnot_si256(dark, far), not_clipped);
}

ATRIUM_AVX2 inline __m256i compensated(__m256i y, __m256i inverse_gain) {
    const __m256i zero = _mm256_setzero_si256();
    const __m256i half = _mm256_set1_epi16(16);
    const auto scale = [&](__m256i wide) __attribute__((target("avx2"))) {
        const __m256i product = _mm256_mulhrs_epi16(_mm256_slli_epi16(wide, 6), inverse_gain);
        return _mm256_srli_epi16(_mm256_add_epi16(product, half), 5);
    };
    return _mm256_packus_epi16(scale(_mm256_unpacklo_epi8(y, zero)),
                               scale(_mm256_unpackhi_epi8(y, zero)));
}

ATRIUM_AVX2 inline void test_luma(
    __m256i y, const std::uint8_t* low, const std::uint8_t* high, __m256i hue, std::uint8_t* out) {
    const __m256i beyond =
        _mm256_or_si256(_mm256_subs_epu8(load(low), y), _mm256_subs_epu8(y, load(high)));
    const __m256i inside = _mm256_cmpeq_epi8(beyond, _mm256_setzero_si256());
    const __m256i outside = _mm256_xor_si256(inside, _mm256_set1_epi8(-1));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_or_si256(outside, hue));
}

// Returns the first block that is left to do.
template <bool kGain>
ATRIUM_AVX2 int test_row_avx2(const BlockRow& row, int num_blocks, const Limits& limits) {
    const __m256i inverse_gain = _mm256_set1_epi16(limits.inverse_gain);
    if (num_blocks < 16) return 0;
    for (int next = 0; next < num_blocks; next += 16) {
        // the last blocks are done with some of those before them, once more
        const int x = std::min(next, num_blocks - 16);
        const int at = 2 * x;
        __m256i top = load(row.top + at);
        __m256i bottom = load(row.bottom + at);
        const __m256i hue = have_other_hue(top, bottom, row, x, limits);
        if constexpr (kGain) {
            top = compensated(top, inverse_gain);
            bottom = compensated(bottom, inverse_gain);
        }
        test_luma(top, row.top_low + at, row.top_high + at, hue, row.top_out + at);
        test_luma(bottom, row.bottom_low + at, row.bottom_high + at, hue, row.bottom_out + at);
    }
    return num_blocks;
}
#undef ATRIUM_AVX2
#endif

BlockRow block_row(const image::YuvView& frame,
                   const BackgroundModel& model,
                   int row,
                   std::uint8_t* out) {
    const std::ptrdiff_t block = static_cast<std::ptrdiff_t>(row) * (model.width() / 2);
    const std::ptrdiff_t top = 4 * block;
    const std::ptrdiff_t bottom = top + model.width();
    return {frame.y.row(2 * row),
            frame.y.row(2 * row + 1),
            frame.u.row(row),
            frame.v.row(row),
            model.luma_low.data() + top,
            model.luma_high.data() + top,
            model.luma_low.data() + bottom,
            model.luma_high.data() + bottom,
            model.ratio_u.data() + block,
            model.ratio_v.data() + block,
            model.whiten_u.data() + block,
            model.whiten_uv.data() + block,
            model.whiten_v.data() + block,
            out,
            out + model.width()};
}

}  // namespace

InstructionSet best_instruction_set() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return InstructionSet::kAvx2;
#endif
    return InstructionSet::kBaseline;
}

void test_rows(const image::YuvView& frame,
               const BackgroundModel& model,
               std::int16_t inverse_gain,
               InstructionSet instructions,
               RowRange rows,
               std::uint8_t* out) {
    assert(frame.width() == model.width() && frame.height() == model.height());
    assert(rows.first % 2 == 0 && rows.end % 2 == 0 && rows.end <= model.height());
    assert(inverse_gain >= 0);
    const Limits limits{model.max_distance_sq, model.min_colour_luma, inverse_gain};
    const int num_blocks = model.width() / 2;
    for (int y = rows.first / 2; y < rows.end / 2; ++y) {
        const BlockRow row = block_row(frame, model, y, out);
        int first = 0;
#if defined(__x86_64__)
        if (instructions == InstructionSet::kAvx2) {
            first = inverse_gain == kUnitGain ? test_row_avx2<false>(row, num_blocks, limits)
                                              : test_row_avx2<true>(row, num_blocks, limits);
        }
#endif
        test_row(row, first, num_blocks, limits);
        out += static_cast<std::ptrdiff_t>(2) * model.width();
    }
}

}  // namespace atrium::segmentation
