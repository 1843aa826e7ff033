#include "site_node/segmentation/bit_rows.hpp"

#include <algorithm>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace atrium::segmentation {
namespace {

constexpr int kWord = 64;

// Returns one bit per byte of `row`, the first lowest; `num` is at most 64.
std::uint64_t word_of(const std::uint8_t* row, int num) {
    std::uint64_t bits = 0;
    int x = 0;
#if defined(__x86_64__)
    for (; x + 16 <= num; x += 16) {
        const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(row + x));
        bits |= static_cast<std::uint64_t>(static_cast<unsigned>(_mm_movemask_epi8(bytes))) << x;
    }
#endif
    for (; x < num; ++x) bits |= static_cast<std::uint64_t>(row[x] & 1) << x;
    return bits;
}

// Neighbours of the pixels of word `w`.
std::uint64_t left_of(const std::uint64_t* row, int w) { return row[w] << 1 | row[w - 1] >> 63; }
std::uint64_t right_of(const std::uint64_t* row, int w) { return row[w] >> 1 | row[w + 1] << 63; }

struct Count {  // 0 to 3
    std::uint64_t ones;
    std::uint64_t twos;
};
Count count(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    return {a ^ b ^ c, (a & b) | (c & (a ^ b))};
}
Count count_row(const std::uint64_t* row, int w) {
    return count(left_of(row, w), row[w], right_of(row, w));
}

// Combines each pixel with its four neighbours.
template <typename Operation>
void combine(const BitRows& in, BitRows& out, const Operation& with) {
    out.shape_like(in);
    for (int y = in.first_row; y < in.end_row(); ++y) {
        const std::uint64_t* const above = in.row(y - 1);
        const std::uint64_t* const here = in.row(y);
        const std::uint64_t* const below = in.row(y + 1);
        std::uint64_t* const result = out.row(y);
        for (int w = 0; w < in.num_words; ++w) {
            const std::uint64_t vertical = with(above[w], below[w]);
            const std::uint64_t horizontal = with(left_of(here, w), right_of(here, w));
            result[w] = with(here[w], with(vertical, horizontal));
        }
    }
    out.repeat_edges();
}

}  // namespace

void BitRows::shape_like(const BitRows& other) {
    width = other.width;
    first_row = other.first_row;
    num_rows = other.num_rows;
    first_word = other.first_word;
    num_words = other.num_words;
    words.reserve(other.words.capacity());
    words.resize(other.words.size());
}

void BitRows::repeat_edges() {
    const int num_last = width - (first_word + num_words - 1) * kWord;
    const std::uint64_t beyond = num_last < kWord ? ~std::uint64_t{0} << num_last : 0;
    for (int y = first_row; y < end_row(); ++y) {
        std::uint64_t* const bits = row(y);
        std::uint64_t& last = bits[num_words - 1];
        const bool is_set = num_last < kWord && (last >> (num_last - 1) & 1) != 0;
        last = is_set ? last | beyond : last & ~beyond;
        bits[-1] = (bits[0] & 1) != 0 ? ~std::uint64_t{0} : 0;
        bits[num_words] = bits[num_words - 1] >> 63 != 0 ? ~std::uint64_t{0} : 0;
    }
    const auto copy = [&](int from, int to) { std::copy_n(row(from) - 1, stride(), row(to) - 1); };
    copy(first_row, first_row - 1);
    copy(end_row() - 1, end_row());
}

bool pack(const image::SparseMask& mask, int margin, BitRows& out) {
    const int width = mask.mask.width;
    const int height = mask.mask.height;
    int top = height;
    int bottom = 0;
    int left = width;
    int right = 0;
    for (int y = 0; y < height; ++y) {
        const image::PixelSpan span = mask.rows[static_cast<std::size_t>(y)];
        if (span.begin == span.end) continue;
        top = std::min(top, y);
        bottom = y + 1;
        left = std::min(left, span.begin);
        right = std::max(right, span.end);
    }
    if (top >= bottom) return false;
    out.width = width;
    out.first_row = std::max(top / 4 * 4 - margin, 0);
    out.num_rows = std::min(bottom + margin, height) - out.first_row;
    out.first_word = std::max(left - margin, 0) / kWord;
    out.num_words = (std::min(right + margin, width) + kWord - 1) / kWord - out.first_word;
    // for the whole picture, so that people who come nearer cause no allocation
    out.words.reserve(static_cast<std::size_t>(height + 2) *
                      static_cast<std::size_t>((width + kWord - 1) / kWord + 2));
    out.words.assign(static_cast<std::size_t>(out.num_rows + 2) * out.stride(), 0);
    for (int y = top; y < bottom; ++y) {
        const image::PixelSpan span = mask.rows[static_cast<std::size_t>(y)];
        std::uint64_t* const bits = out.row(y);
        for (int word = span.begin / kWord; word * kWord < span.end; ++word) {
            const int x = word * kWord;
            const int num = std::min(kWord, width - x);
            bits[word - out.first_word] = word_of(mask.mask.row(y) + x, num);
        }
    }
    out.repeat_edges();
    return true;
}

void erode(const BitRows& in, BitRows& out) {
    combine(in, out, [](std::uint64_t a, std::uint64_t b) { return a & b; });
}

void dilate(const BitRows& in, BitRows& out) {
    combine(in, out, [](std::uint64_t a, std::uint64_t b) { return a | b; });
}

// Adds nine bits of each of 64 pixels at once.
void majority(const BitRows& in, const BitRows& where, BitRows& out) {
    out.shape_like(in);
    for (int y = in.first_row; y < in.end_row(); ++y) {
        const std::uint64_t* const wanted = where.row(y);
        const std::uint64_t* const here = in.row(y);
        std::uint64_t* const result = out.row(y);
        for (int w = 0; w < in.num_words; ++w) {
            if (wanted[w] == 0) {
                result[w] = here[w];
                continue;
            }
            const Count a = count_row(in.row(y - 1), w);
            const Count b = count_row(here, w);
            const Count c = count_row(in.row(y + 1), w);
            const Count ones = count(a.ones, b.ones, c.ones);
            // 5 of 9: at least three twos, or two and a one
            const std::uint64_t ab = a.twos & b.twos;
            const std::uint64_t cd = c.twos & ones.twos;
            const std::uint64_t a_or_b = a.twos | b.twos;
            const std::uint64_t c_or_d = c.twos | ones.twos;
            const std::uint64_t three = (ab & c_or_d) | (cd & a_or_b);
            const std::uint64_t two = ab | cd | (a_or_b & c_or_d);
            const std::uint64_t most = three | (two & ones.ones);
            result[w] = (most & wanted[w]) | (here[w] & ~wanted[w]);
        }
    }
    out.repeat_edges();
}

}  // namespace atrium::segmentation
