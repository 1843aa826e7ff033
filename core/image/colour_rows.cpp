#include "core/image/colour_rows.hpp"

#include <algorithm>
#include <utility>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace atrium::image {
namespace {

// BT.601: luma in 1/65536, chroma in 1/32768; each row of the matrix sums to one, or to nothing.
constexpr std::uint16_t kYR = 19595, kYG = 38470, kYB = 7471;
constexpr std::int16_t kUB = 16384, kUR = -5529, kUG = -(kUB + kUR);
constexpr std::int16_t kVR = 16384, kVB = -2665, kVG = -(kVR + kVB);
// Chroma is made from 1/128 of grey levels, which is all that 16 bits hold.
constexpr int kHalfLevel = 64;
// Luma from 1/256, cut off three times: a half, and one and a half for that.
constexpr int kHalfLuma = 129;

// Rounded product with a factor in 1/32768.
int scaled(int value, int factor) { return (value * factor + (1 << 14)) >> 15; }

std::uint8_t luma(int b, int g, int r) {
    return static_cast<std::uint8_t>(
        (((b * kYB) >> 8) + ((g * kYG) >> 8) + ((r * kYR) >> 8) + kHalfLuma) >> 8);
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

ATRIUM_AVX2 inline __m256i sum_of(__m256i a, __m256i b, __m256i c) {
    return _mm256_add_epi16(_mm256_add_epi16(a, b),
                            _mm256_add_epi16(c, _mm256_set1_epi16(kHalfLevel)));
}

// Of bytes in the upper halves of words.
ATRIUM_AVX2 inline __m256i luma(const Colours& c) {
    const __m256i b = _mm256_mulhi_epu16(c.b, _mm256_set1_epi16(static_cast<short>(kYB)));
    const __m256i g = _mm256_mulhi_epu16(c.g, _mm256_set1_epi16(static_cast<short>(kYG)));
    const __m256i r = _mm256_mulhi_epu16(c.r, _mm256_set1_epi16(static_cast<short>(kYR)));
    const __m256i sum =
        _mm256_add_epi16(_mm256_add_epi16(b, g), _mm256_add_epi16(r, _mm256_set1_epi16(kHalfLuma)));
    return _mm256_srli_epi16(sum, 8);
}

// 16 values of one kind; the saturating pack does what std::min does.
ATRIUM_AVX2 inline void store_bytes(__m256i words, std::uint8_t* out) {
    const __m256i packed = _mm256_packus_epi16(words, words);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out),
                     _mm256_castsi256_si128(_mm256_permute4x64_epi64(packed, 0x08)));
}

ATRIUM_AVX2 inline void store_chroma(const Colours& c, std::uint8_t* u, std::uint8_t* v) {
    const __m256i middle = _mm256_set1_epi16(128);
    const __m256i cb = sum_of(times(c.b, kUB), times(c.g, kUG), times(c.r, kUR));
    const __m256i cr = sum_of(times(c.r, kVR), times(c.g, kVG), times(c.b, kVB));
    store_bytes(_mm256_add_epi16(_mm256_srai_epi16(cb, 7), middle), u);
    store_bytes(_mm256_add_epi16(_mm256_srai_epi16(cr, 7), middle), v);
}

ATRIUM_AVX2 inline __m256i load_halves(const std::uint8_t* low, const std::uint8_t* high) {
    return _mm256_inserti128_si256(
        _mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(low))),
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(high)),
        1);
}

ATRIUM_AVX2 inline __m256i both_halves(__m128i half) { return _mm256_broadcastsi128_si256(half); }

// Bytes of one channel from three vectors of packed pixels: byte i of the result comes from byte
// 3 i + channel of 48.
template <int kChannel>
ATRIUM_AVX2 inline __m256i channel(__m256i first, __m256i second, __m256i third) {
    constexpr auto kAt = [](int i, int part) {
        const int from = 3 * i + kChannel - 16 * part;
        return static_cast<char>(from >= 0 && from < 16 ? from : -128);
    };
    const auto pick = [&](int part) __attribute__((target("avx2"), always_inline)) {
        return both_halves(_mm_setr_epi8(kAt(0, part),
                                         kAt(1, part),
                                         kAt(2, part),
                                         kAt(3, part),
                                         kAt(4, part),
                                         kAt(5, part),
                                         kAt(6, part),
                                         kAt(7, part),
                                         kAt(8, part),
                                         kAt(9, part),
                                         kAt(10, part),
                                         kAt(11, part),
                                         kAt(12, part),
                                         kAt(13, part),
                                         kAt(14, part),
                                         kAt(15, part)));
    };
    return _mm256_or_si256(
        _mm256_or_si256(_mm256_shuffle_epi8(first, pick(0)), _mm256_shuffle_epi8(second, pick(1))),
        _mm256_shuffle_epi8(third, pick(2)));
}

// 32 packed pixels to a vector of bytes per channel, in the order of the bytes.
ATRIUM_AVX2 inline Colours split(const std::uint8_t* pixels) {
    const __m256i first = load_halves(pixels, pixels + 48);
    const __m256i second = load_halves(pixels + 16, pixels + 64);
    const __m256i third = load_halves(pixels + 32, pixels + 80);
    return {channel<0>(first, second, third),
            channel<1>(first, second, third),
            channel<2>(first, second, third)};
}

ATRIUM_AVX2 inline void store_luma(const Colours& c, std::uint8_t* out) {
    const __m256i zero = _mm256_setzero_si256();
    const Colours low{_mm256_unpacklo_epi8(zero, c.b),
                      _mm256_unpacklo_epi8(zero, c.g),
                      _mm256_unpacklo_epi8(zero, c.r)};
    const Colours high{_mm256_unpackhi_epi8(zero, c.b),
                       _mm256_unpackhi_epi8(zero, c.g),
                       _mm256_unpackhi_epi8(zero, c.r)};
    const __m256i packed = _mm256_packus_epi16(luma(low), luma(high));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), packed);
}

ATRIUM_AVX2 inline __m256i block_means(__m256i top, __m256i bottom) {
    const __m256i ones = _mm256_set1_epi8(1);
    return _mm256_slli_epi16(
        _mm256_add_epi16(_mm256_maddubs_epi16(top, ones), _mm256_maddubs_epi16(bottom, ones)), 5);
}

// Both return the first column that is left to do.
ATRIUM_AVX2 int packed_avx2(const PackedRows& in, const YuvRows& out) {
    if (in.width < 32) return 0;
    for (int next = 0; next < in.width; next += 32) {
        // the last columns are done with some of those before them, once more
        const int x = std::min(next, in.width - 32);
        Colours top = split(in.top + 3 * x);
        Colours bottom = split(in.bottom + 3 * x);
        if (!in.blue_first) {
            std::swap(top.b, top.r);
            std::swap(bottom.b, bottom.r);
        }
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
