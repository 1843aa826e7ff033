#include "core/image/colour_rows.hpp"

#include <algorithm>
#include <array>
#include <utility>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace atrium::image {
namespace {

// BT.601. Luma in 1/184: of all denominators that keep sums of bytes within 16 bits, this one fits
// the matrix best, to 0.0002. 1/184 is slightly less than 356/65536; the rounding compensates.
constexpr int kYR = 55, kYG = 108, kYB = 21;
constexpr int kYHalf = 103;
constexpr int kYInverse = 356;
// Chroma in 1/32768. Each row of the matrix sums to zero.
constexpr std::int16_t kUB = 16384, kUR = -5529, kUG = -(kUB + kUR);
constexpr std::int16_t kVR = 16384, kVB = -2665, kVG = -(kVR + kVB);
// Chroma is computed in 1/128 grey levels, the finest that 16 bits hold.
constexpr int kHalfLevel = 64;

// Product with a factor in 1/32768, rounded.
int scaled(int value, int factor) { return (value * factor + (1 << 14)) >> 15; }

std::uint8_t luma(int b, int g, int r) {
    return static_cast<std::uint8_t>(((b * kYB + g * kYG + r * kYR + kYHalf) * kYInverse) >> 16);
}

// Blue, green, red in 1/128.
void chroma(int b, int g, int r, std::uint8_t& u, std::uint8_t& v) {
    const int cb = (scaled(b, kUB) + scaled(g, kUG) + scaled(r, kUR) + kHalfLevel) >> 7;
    const int cr = (scaled(r, kVR) + scaled(g, kVG) + scaled(b, kVB) + kHalfLevel) >> 7;
    u = static_cast<std::uint8_t>(std::min(cb + 128, 255));
    v = static_cast<std::uint8_t>(std::min(cr + 128, 255));
}

void packed_baseline(const PackedRows& in, int first, const YuvRows& out) {
    const int blue = in.blue_first ? 0 : 2;
    const int red = 2 - blue;
    for (int x = first; x < in.width; x += 2) {
        int b = 0, g = 0, r = 0;
        for (int at = x; at < x + 2; ++at) {
            const std::uint8_t* top = in.top + 3 * at;
            const std::uint8_t* bottom = in.bottom + 3 * at;
            out.top_luma[at] = luma(top[blue], top[1], top[red]);
            out.bottom_luma[at] = luma(bottom[blue], bottom[1], bottom[red]);
            b += top[blue] + bottom[blue];
            g += top[1] + bottom[1];
            r += top[red] + bottom[red];
        }
        chroma(b << 5, g << 5, r << 5, out.u[x / 2], out.v[x / 2]);
    }
}

void mosaic_baseline(const MosaicRows& in, int first, std::uint8_t* u, std::uint8_t* v) {
    for (int x = first; x < in.num_blocks; ++x) {
        const std::uint8_t* red = in.red_row + 2 * x;
        const std::uint8_t* blue = in.blue_row + 2 * x;
        const int green = red[1 - in.red_x] + blue[in.red_x];
        chroma(blue[1 - in.red_x] << 7, green << 6, red[in.red_x] << 7, u[x], v[x]);
    }
}

#if defined(__x86_64__)
#define ATRIUM_AVX2 __attribute__((target("avx2")))

ATRIUM_AVX2 inline __m256i times(__m256i value, std::int16_t factor) {
    return _mm256_mulhrs_epi16(value, _mm256_set1_epi16(factor));
}

struct Colours {
    __m256i b, g, r;
};

// Chroma in 1/128, offset by 128 grey levels: never negative, it may use all 16 bits.
ATRIUM_AVX2 inline __m256i grey_levels(__m256i a, __m256i b, __m256i c) {
    const __m256i shift = _mm256_set1_epi16((128 << 7) + kHalfLevel);
    const __m256i sum = _mm256_add_epi16(_mm256_add_epi16(a, b), _mm256_add_epi16(c, shift));
    return _mm256_srli_epi16(sum, 7);
}

// The saturating pack replaces the std::min of the baseline.
ATRIUM_AVX2 inline void store_chroma(const Colours& c, std::uint8_t* u, std::uint8_t* v) {
    const __m256i cb = grey_levels(times(c.b, kUB), times(c.g, kUG), times(c.r, kUR));
    const __m256i cr = grey_levels(times(c.r, kVR), times(c.g, kVG), times(c.b, kVB));
    const __m256i both = _mm256_permute4x64_epi64(_mm256_packus_epi16(cb, cr), 0xd8);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(u), _mm256_castsi256_si128(both));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(v), _mm256_extracti128_si256(both, 1));
}

ATRIUM_AVX2 inline __m256i load_halves(const std::uint8_t* low, const std::uint8_t* high) {
    return _mm256_inserti128_si256(
        _mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(low))),
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(high)),
        1);
}

// Gathers four packed pixels as four bytes each of blue, green and red; the rest is unused.
alignas(16) constexpr std::array<std::int8_t, 16> kBlueFirst{
    0, 3, 6, 9, 1, 4, 7, 10, 2, 5, 8, 11, 0, 0, 0, 0};
alignas(16) constexpr std::array<std::int8_t, 16> kRedFirst{
    2, 5, 8, 11, 1, 4, 7, 10, 0, 3, 6, 9, 0, 0, 0, 0};

struct Gather {
    __m256i at_begin;
    __m256i at_end;  // in the last 12 of 16 bytes
};

ATRIUM_AVX2 inline Gather gather(bool blue_first) {
    const auto& order = blue_first ? kBlueFirst : kRedFirst;
    const __m256i at_begin =
        _mm256_broadcastsi128_si256(_mm_load_si128(reinterpret_cast<const __m128i*>(order.data())));
    return {at_begin, _mm256_add_epi8(at_begin, _mm256_set1_epi8(4))};
}

// Splits 32 packed pixels into one vector of bytes per channel: shuffles groups of four pixels,
// then transposes the groups like a matrix. The last four pixels are loaded with the bytes before
// them, not after.
ATRIUM_AVX2 inline Colours split(const std::uint8_t* pixels, const Gather& order) {
    const __m256i a = _mm256_shuffle_epi8(load_halves(pixels, pixels + 48), order.at_begin);
    const __m256i b = _mm256_shuffle_epi8(load_halves(pixels + 12, pixels + 60), order.at_begin);
    const __m256i c = _mm256_shuffle_epi8(load_halves(pixels + 24, pixels + 72), order.at_begin);
    const __m256i d = _mm256_shuffle_epi8(load_halves(pixels + 32, pixels + 80), order.at_end);
    const __m256i blue_green_1 = _mm256_unpacklo_epi32(a, b);
    const __m256i blue_green_2 = _mm256_unpacklo_epi32(c, d);
    return {_mm256_unpacklo_epi64(blue_green_1, blue_green_2),
            _mm256_unpackhi_epi64(blue_green_1, blue_green_2),
            _mm256_unpacklo_epi64(_mm256_unpackhi_epi32(a, b), _mm256_unpackhi_epi32(c, d))};
}

// Alternating factors of two bytes, for _mm256_maddubs_epi16.
ATRIUM_AVX2 inline __m256i factors(int first, int second) {
    return _mm256_set1_epi16(static_cast<short>(second << 8 | first));
}

// Adds half of green to blue and half to red: each pair stays within 16 bits.
ATRIUM_AVX2 inline __m256i luma(__m256i blue_green, __m256i green_red) {
    static_assert((kYB + kYG / 2) * 255 < 32768 && (kYG / 2 + kYR) * 255 < 32768 && kYG % 2 == 0);
    const __m256i sum = _mm256_add_epi16(_mm256_maddubs_epi16(blue_green, factors(kYB, kYG / 2)),
                                         _mm256_maddubs_epi16(green_red, factors(kYG / 2, kYR)));
    return _mm256_mulhi_epu16(_mm256_add_epi16(sum, _mm256_set1_epi16(kYHalf)),
                              _mm256_set1_epi16(kYInverse));
}

ATRIUM_AVX2 inline void store_luma(const Colours& c, std::uint8_t* out) {
    const __m256i low = luma(_mm256_unpacklo_epi8(c.b, c.g), _mm256_unpacklo_epi8(c.g, c.r));
    const __m256i high = luma(_mm256_unpackhi_epi8(c.b, c.g), _mm256_unpackhi_epi8(c.g, c.r));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_packus_epi16(low, high));
}

// Means of 2x2 blocks, in 1/128.
ATRIUM_AVX2 inline __m256i block_means(__m256i top, __m256i bottom) {
    const __m256i quarter = _mm256_set1_epi8(128 / 4);
    return _mm256_add_epi16(_mm256_maddubs_epi16(top, quarter),
                            _mm256_maddubs_epi16(bottom, quarter));
}

// Prefetches byte `at` of the next two rows: hardware does not predict rows in pairs. Uses
// integers, because the next rows may not exist.
inline void prefetch(const std::uint8_t* top, const std::uint8_t* bottom, int at) {
    const auto first = reinterpret_cast<std::uintptr_t>(top);
    const auto second = reinterpret_cast<std::uintptr_t>(bottom);
    const std::uintptr_t ahead = 2 * (second - first) + static_cast<std::uintptr_t>(at);
    _mm_prefetch(reinterpret_cast<const char*>(first + ahead), _MM_HINT_T0);
    _mm_prefetch(reinterpret_cast<const char*>(second + ahead), _MM_HINT_T0);
}

// This and mosaic_avx2 return the first column that is left to do.
ATRIUM_AVX2 int packed_avx2(const PackedRows& in, const YuvRows& out) {
    if (in.width < 32) return 0;
    const Gather order = gather(in.blue_first);
    for (int next = 0; next < in.width; next += 32) {
        // the last columns are computed together with some earlier ones, again
        const int x = std::min(next, in.width - 32);
        prefetch(in.top, in.bottom, 3 * x);
        prefetch(in.top, in.bottom, 3 * x + 64);
        prefetch(out.top_luma, out.bottom_luma, x);
        const Colours top = split(in.top + 3 * x, order);
        const Colours bottom = split(in.bottom + 3 * x, order);
        store_luma(top, out.top_luma + x);
        store_luma(bottom, out.bottom_luma + x);
        store_chroma({block_means(top.b, bottom.b),
                      block_means(top.g, bottom.g),
                      block_means(top.r, bottom.r)},
                     out.u + x / 2,
                     out.v + x / 2);
    }
    return in.width;
}

ATRIUM_AVX2 int mosaic_avx2(const MosaicRows& in, std::uint8_t* u, std::uint8_t* v) {
    const __m256i low_byte = _mm256_set1_epi16(0xff);
    if (in.num_blocks < 16) return 0;
    for (int next = 0; next < in.num_blocks; next += 16) {
        const int x = std::min(next, in.num_blocks - 16);
        const __m256i reds =
            _mm256_loadu_si256(reinterpret_cast<const __m256i*>(in.red_row + 2 * x));
        const __m256i blues =
            _mm256_loadu_si256(reinterpret_cast<const __m256i*>(in.blue_row + 2 * x));
        __m256i red = _mm256_and_si256(reds, low_byte);
        __m256i red_green = _mm256_srli_epi16(reds, 8);
        __m256i blue = _mm256_srli_epi16(blues, 8);
        __m256i blue_green = _mm256_and_si256(blues, low_byte);
        if (in.red_x != 0) {
            std::swap(red, red_green);
            std::swap(blue, blue_green);
        }
        store_chroma({_mm256_slli_epi16(blue, 7),
                      _mm256_slli_epi16(_mm256_add_epi16(red_green, blue_green), 6),
                      _mm256_slli_epi16(red, 7)},
                     u + x,
                     v + x);
    }
    return in.num_blocks;
}
#undef ATRIUM_AVX2
#endif

}  // namespace

RowCode best_row_code() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return RowCode::kAvx2;
#endif
    return RowCode::kBaseline;
}

void yuv_of_packed_rows(const PackedRows& in, const YuvRows& out, RowCode code) {
    int first = 0;
#if defined(__x86_64__)
    if (code == RowCode::kAvx2) first = packed_avx2(in, out);
#endif
    packed_baseline(in, first, out);
}

void chroma_of_mosaic_rows(const MosaicRows& in, std::uint8_t* u, std::uint8_t* v, RowCode code) {
    int first = 0;
#if defined(__x86_64__)
    if (code == RowCode::kAvx2) first = mosaic_avx2(in, u, v);
#endif
    mosaic_baseline(in, first, u, v);
}

}  // namespace atrium::image
