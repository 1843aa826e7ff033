#include "site_node/segmentation/pixel_test.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace atrium::segmentation {
namespace {

// Limit of a chroma deviation, in quarters: far beyond any threshold, and all later values fit 16
// bits.
constexpr int kMaxDeviation = 1023;
// Prefetch distance in rows of blocks: every second row is tested first, and the model is in no
// cache.
constexpr int kRowsAhead = 2;
static_assert(kTestCell == kPixelsPerGroup);

// Two rows of pixels and their row of blocks.
struct BlockRow {
    const std::uint8_t* top;
    const std::uint8_t* bottom;
    const std::uint8_t* u;
    const std::uint8_t* v;
    const RoomLook* looks;
    const HueNoise* hue_noise;
    std::ptrdiff_t ahead;  // prefetch distance in groups
    std::uint8_t* top_out;
    std::uint8_t* bottom_out;
    std::int32_t near_hue_sq;  // BackgroundModel::near_hue_sq
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

// No branches, here and below: the compiler then vectorises the loops with baseline instructions.
std::uint8_t has_other_hue(const BlockRow& row,
                           int x,
                           const RoomLook& look,
                           const HueNoise& noise,
                           std::size_t block,  // within the group
                           const Limits& limits) {
    const int at = 2 * x;
    const int sum = row.top[at] + row.top[at + 1] + row.bottom[at] + row.bottom[at + 1];
    const int brightest = std::max(std::max(row.top[at], row.top[at + 1]),
                                   std::max(row.bottom[at], row.bottom[at + 1]));
    const auto luma = static_cast<std::int16_t>(8 * sum);
    const std::int16_t du = deviation(row.u[x], luma, look.ratio_u[block]);
    const std::int16_t dv = deviation(row.v[x], luma, look.ratio_v[block]);
    const std::int32_t a = scaled(du, noise.whiten_u[block]);
    const std::int32_t b = scaled(du, noise.whiten_uv[block]) + scaled(dv, noise.whiten_v[block]);
    const int has_hue = (sum >= limits.min_colour_luma) & (brightest < kClipped);
    return static_cast<std::uint8_t>(-(has_hue & (a * a + b * b > limits.max_distance_sq)));
}

// Tests one row of pixels; `hue` is that of their blocks, 255 or 0.
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

// Tests blocks [first, end), all in one group.
void test_group(const BlockRow& row, int first, int end, const Limits& limits) {
    const RoomLook& look = row.looks[first / kBlocksPerGroup];
    const HueNoise& noise = row.hue_noise[first / kBlocksPerGroup];
    const auto first_block = static_cast<std::size_t>(first % kBlocksPerGroup);
    const auto num_blocks = static_cast<std::size_t>(end - first);
    std::array<std::uint8_t, kBlocksPerGroup> hue_of_blocks;
    std::array<std::uint8_t, kPixelsPerGroup> hue;
    for (std::size_t i = 0; i < num_blocks; ++i) {
        hue_of_blocks[i] =
            has_other_hue(row, first + static_cast<int>(i), look, noise, first_block + i, limits);
    }
    for (std::size_t i = 0; i < num_blocks; ++i) hue[2 * i] = hue[2 * i + 1] = hue_of_blocks[i];
    const int in_group = 2 * (first % kBlocksPerGroup);
    const int num = 2 * (end - first);
    const std::array<const std::uint8_t*, 2> lumas{row.top, row.bottom};
    const std::array<std::uint8_t*, 2> outs{row.top_out, row.bottom_out};
    for (std::size_t line = 0; line < lumas.size(); ++line) {
        test_pixels(lumas[line] + 2 * first,
                    look.luma_low[line].data() + in_group,
                    look.luma_high[line].data() + in_group,
                    hue.data(),
                    num,
                    limits.inverse_gain,
                    outs[line] + 2 * first);
    }
}

void test_row(const BlockRow& row, int first, int end, const Limits& limits) {
    while (first < end) {
        const int next = std::min((first / kBlocksPerGroup + 1) * kBlocksPerGroup, end);
        test_group(row, first, next, limits);
        first = next;
    }
}

bool has_foreground(const BlockRow& row, int first, int end) {
    std::uint8_t any = 0;
    for (int x = 2 * first; x < 2 * end; ++x)
        any = static_cast<std::uint8_t>(any | row.top_out[x] | row.bottom_out[x]);
    return any != 0;
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

ATRIUM_AVX2 inline __m256i deviation(__m256i chroma,
                                     __m256i luma,
                                     const std::array<std::int16_t, kBlocksPerGroup>& ratio) {
    return _mm256_sub_epi16(chroma, _mm256_mulhrs_epi16(luma, load(ratio.data())));
}

ATRIUM_AVX2 inline __m256i cut(__m256i quarters) {
    const __m256i bounded =
        _mm256_min_epi16(_mm256_max_epi16(quarters, _mm256_set1_epi16(-kMaxDeviation)),
                         _mm256_set1_epi16(kMaxDeviation));
    return _mm256_slli_epi16(bounded, 4);
}

// Per 32 bits: compares a^2 + b^2 with a limit, for the lower and upper halves of each 128 bits.
struct FarHalves {
    __m256i low;
    __m256i high;
};
ATRIUM_AVX2 inline FarHalves are_far(__m256i a, __m256i b, std::int32_t limit) {
    const __m256i most = _mm256_set1_epi32(limit);
    const __m256i low = _mm256_unpacklo_epi16(a, b);
    const __m256i high = _mm256_unpackhi_epi16(a, b);
    return {_mm256_cmpgt_epi32(_mm256_madd_epi16(low, low), most),
            _mm256_cmpgt_epi32(_mm256_madd_epi16(high, high), most)};
}

// Returns the hue test of 16 blocks, 255 or 0 in both bytes of a block, one per pixel column.
// Usually all blocks have the room's hue, and their noise is not read.
ATRIUM_AVX2 inline __m256i have_other_hue(
    __m256i top, __m256i bottom, const BlockRow& row, int x, const Limits& limits) {
    const __m256i ones = _mm256_set1_epi8(1);
    const __m256i sum =
        _mm256_add_epi16(_mm256_maddubs_epi16(top, ones), _mm256_maddubs_epi16(bottom, ones));
    const __m256i luma = _mm256_slli_epi16(sum, 3);
    const RoomLook& look = row.looks[x / kBlocksPerGroup];
    const __m256i quarters_u = deviation(load_chroma(row.u + x), luma, look.ratio_u);
    const __m256i quarters_v = deviation(load_chroma(row.v + x), luma, look.ratio_v);
    const FarHalves may_be_far = are_far(quarters_u, quarters_v, row.near_hue_sq);
    const __m256i any = _mm256_or_si256(may_be_far.low, may_be_far.high);
    if (_mm256_testz_si256(any, any) != 0) return _mm256_setzero_si256();

    const __m256i brightest = _mm256_max_epu8(top, bottom);
    const __m256i not_clipped = _mm256_cmpeq_epi16(
        _mm256_subs_epu8(brightest, _mm256_set1_epi8(static_cast<char>(kClipped - 1))),
        _mm256_setzero_si256());
    const __m256i dark = _mm256_cmpgt_epi16(_mm256_set1_epi16(limits.min_colour_luma), sum);
    const __m256i du = cut(quarters_u);
    const __m256i dv = cut(quarters_v);
    const HueNoise& noise = row.hue_noise[x / kBlocksPerGroup];
    const __m256i a = _mm256_mulhrs_epi16(du, load(noise.whiten_u.data()));
    const __m256i b = _mm256_add_epi16(_mm256_mulhrs_epi16(du, load(noise.whiten_uv.data())),
                                       _mm256_mulhrs_epi16(dv, load(noise.whiten_v.data())));
    const FarHalves halves = are_far(a, b, limits.max_distance_sq);
    const __m256i far = _mm256_packs_epi32(halves.low, halves.high);
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

ATRIUM_AVX2 inline __m256i test_luma(
    __m256i y, const RoomLook& look, std::size_t line, __m256i hue, std::uint8_t* out) {
    const __m256i beyond = _mm256_or_si256(_mm256_subs_epu8(load(look.luma_low[line].data()), y),
                                           _mm256_subs_epu8(y, load(look.luma_high[line].data())));
    const __m256i inside = _mm256_cmpeq_epi8(beyond, _mm256_setzero_si256());
    const __m256i outside = _mm256_xor_si256(inside, _mm256_set1_epi8(-1));
    const __m256i foreground = _mm256_or_si256(outside, hue);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), foreground);
    return foreground;
}

ATRIUM_AVX2 inline void fetch(const RoomLook& look) {
    const auto* const bytes = reinterpret_cast<const char*>(&look);
    for (std::size_t at = 0; at < sizeof look; at += 64) _mm_prefetch(bytes + at, _MM_HINT_T0);
}

// Tests 16 blocks of one group from x on. Returns true if any pixel is foreground.
template <bool kGain>
ATRIUM_AVX2 inline bool test_group_avx2(const BlockRow& row, int x, const Limits& limits) {
    const int at = 2 * x;
    const RoomLook& look = row.looks[x / kBlocksPerGroup];
    fetch(*(&look + row.ahead));
    __m256i top = load(row.top + at);
    __m256i bottom = load(row.bottom + at);
    const __m256i hue = have_other_hue(top, bottom, row, x, limits);
    if constexpr (kGain) {
        const __m256i inverse_gain = _mm256_set1_epi16(limits.inverse_gain);
        top = compensated(top, inverse_gain);
        bottom = compensated(bottom, inverse_gain);
    }
    const __m256i any = _mm256_or_si256(test_luma(top, look, 0, hue, row.top_out + at),
                                        test_luma(bottom, look, 1, hue, row.bottom_out + at));
    return _mm256_testz_si256(any, any) == 0;
}

// Copies of a group of which the row has only the first blocks.
struct PaddedGroup {
    std::array<std::uint8_t, kPixelsPerGroup> top{};
    std::array<std::uint8_t, kPixelsPerGroup> bottom{};
    std::array<std::uint8_t, kBlocksPerGroup> u{};
    std::array<std::uint8_t, kBlocksPerGroup> v{};
    std::array<std::uint8_t, kPixelsPerGroup> top_out;
    std::array<std::uint8_t, kPixelsPerGroup> bottom_out;
};

// Tests the first `num` blocks of a group, from x on.
template <bool kGain>
ATRIUM_AVX2 bool test_part_of_group_avx2(const BlockRow& row,
                                         int x,
                                         int num,
                                         const Limits& limits) {
    PaddedGroup group;
    std::copy_n(row.top + 2 * x, 2 * num, group.top.data());
    std::copy_n(row.bottom + 2 * x, 2 * num, group.bottom.data());
    std::copy_n(row.u + x, num, group.u.data());
    std::copy_n(row.v + x, num, group.v.data());
    const BlockRow padded{group.top.data(),
                          group.bottom.data(),
                          group.u.data(),
                          group.v.data(),
                          row.looks + x / kBlocksPerGroup,
                          row.hue_noise + x / kBlocksPerGroup,
                          0,
                          group.top_out.data(),
                          group.bottom_out.data(),
                          row.near_hue_sq};
    test_group_avx2<kGain>(padded, 0, limits);
    std::copy_n(group.top_out.data(), 2 * num, row.top_out + 2 * x);
    std::copy_n(group.bottom_out.data(), 2 * num, row.bottom_out + 2 * x);
    return has_foreground(row, x, x + num);
}

// Tests blocks [first, end) and sets their cells; `first` begins a group.
template <bool kGain>
ATRIUM_AVX2 void test_row_avx2(
    const BlockRow& row, int first, int end, const Limits& limits, std::uint8_t* cells) {
    for (int x = first; x < end; x += kBlocksPerGroup) {
        const bool has_any = x + kBlocksPerGroup <= end
                                 ? test_group_avx2<kGain>(row, x, limits)
                                 : test_part_of_group_avx2<kGain>(row, x, end - x, limits);
        if (cells != nullptr) *cells++ |= static_cast<std::uint8_t>(has_any);
    }
}
#undef ATRIUM_AVX2
#endif

BlockRow block_row(const image::YuvView& frame,
                   const BackgroundModel& model,
                   int row,
                   const TestedRows& out) {
    return {frame.y.row(2 * row),
            frame.y.row(2 * row + 1),
            frame.u.row(row),
            frame.v.row(row),
            model.looks.data() + model.first_group(row),
            model.hue_noise.data() + model.first_group(row),
            row + kRowsAhead < model.height() / 2 ? kRowsAhead * model.groups_per_row() : 0,
            out.top,
            out.bottom,
            model.near_hue_sq[static_cast<std::size_t>(row)]};
}

}  // namespace

InstructionSet best_instruction_set() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return InstructionSet::kAvx2;
#endif
    return InstructionSet::kBaseline;
}

void test_part(const image::YuvView& frame,
               const BackgroundModel& model,
               std::int16_t inverse_gain,
               [[maybe_unused]] InstructionSet instructions,
               const image::PixelRect& part,
               const TestedRows& out) {
    assert((part.x | part.y | part.width) % 2 == 0 && part.height == 2);
    assert(part.x >= 0 && part.x + part.width <= model.width());
    assert(frame.width() == model.width() && frame.height() == model.height());
    assert(inverse_gain >= 0);
    const Limits limits{model.max_distance_sq, model.min_colour_luma, inverse_gain};
    const BlockRow row = block_row(frame, model, part.y / 2, out);
    const int first = part.x / 2;
    const int end = first + part.width / 2;
#if defined(__x86_64__)
    if (instructions == InstructionSet::kAvx2 && first % kBlocksPerGroup == 0) {
        return inverse_gain == kUnitGain ? test_row_avx2<false>(row, first, end, limits, out.cells)
                                         : test_row_avx2<true>(row, first, end, limits, out.cells);
    }
#endif
    test_row(row, first, end, limits);
    if (out.cells == nullptr) return;
    for (int cell = 0; first + cell * kTestCell / 2 < end; ++cell) {
        const int left = first + cell * kTestCell / 2;
        out.cells[cell] |= static_cast<std::uint8_t>(
            has_foreground(row, left, std::min(left + kTestCell / 2, end)));
    }
}

}  // namespace atrium::segmentation
