#include "site_node/segmentation/clean_mask.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace atrium::segmentation {
namespace {

using Run = CleanScratch::Run;

// Returns one bit per pixel of 32, the leftmost lowest.
std::uint32_t bits_of(const std::uint8_t* row) {
#if defined(__x86_64__)
    const auto half = [](const std::uint8_t* bytes) {
        return static_cast<std::uint32_t>(
            _mm_movemask_epi8(_mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes))));
    };
    return half(row) | half(row + 16) << 16;
#else
    std::uint32_t bits = 0;
    for (int i = 0; i < 32; ++i) bits |= static_cast<std::uint32_t>(row[i] & 1) << i;
    return bits;
#endif
}

// Foreground is -1 as a signed byte, so votes are counted below zero.
void majority_baseline(const ThreeRows& in, std::int8_t* votes, std::uint8_t* out) {
    const auto width = static_cast<std::size_t>(in.width);
    for (std::size_t x = 0; x < width; ++x)
        votes[x + 1] = static_cast<std::int8_t>(in.above[x] + in.here[x] + in.below[x]);
    votes[0] = votes[1];
    votes[width + 1] = votes[width];
    for (std::size_t x = 0; x < width; ++x)
        out[x] = votes[x] + votes[x + 1] + votes[x + 2] <= -5 ? 255 : 0;
}

#if defined(__x86_64__)
#define ATRIUM_AVX2 __attribute__((target("avx2")))

ATRIUM_AVX2 inline __m256i load(const void* bytes) {
    return _mm256_loadu_si256(static_cast<const __m256i*>(bytes));
}

ATRIUM_AVX2 inline void store(__m256i value, void* bytes) {
    _mm256_storeu_si256(static_cast<__m256i*>(bytes), value);
}

// For rows of at least 32 pixels. The last step overlaps the one before it.
ATRIUM_AVX2 void majority_avx2(const ThreeRows& in, std::int8_t* votes, std::uint8_t* out) {
    __m256i any = _mm256_setzero_si256();
    for (int next = 0; next < in.width; next += 32) {
        const int x = std::min(next, in.width - 32);
        const __m256i sum = _mm256_add_epi8(_mm256_add_epi8(load(in.above + x), load(in.here + x)),
                                            load(in.below + x));
        store(sum, votes + x + 1);
        any = _mm256_or_si256(any, sum);
    }
    if (_mm256_testz_si256(any, any) != 0) {
        std::memset(out, 0, static_cast<std::size_t>(in.width));
        return;
    }
    votes[0] = votes[1];
    votes[in.width + 1] = votes[in.width];
    const __m256i too_few = _mm256_set1_epi8(-4);
    for (int next = 0; next < in.width; next += 32) {
        const int x = std::min(next, in.width - 32);
        const __m256i sum = _mm256_add_epi8(_mm256_add_epi8(load(votes + x), load(votes + x + 1)),
                                            load(votes + x + 2));
        store(_mm256_cmpgt_epi8(too_few, sum), out + x);
    }
}
#undef ATRIUM_AVX2
#endif

std::uint32_t find(Run* runs, std::uint32_t i) {
    while (runs[i].component != i) {
        runs[i].component = runs[runs[i].component].component;
        i = runs[i].component;
    }
    return i;
}

void unite(Run* runs, std::uint32_t a, std::uint32_t b) {
    a = find(runs, a);
    b = find(runs, b);
    if (a == b) return;
    if (b < a) std::swap(a, b);
    runs[b].component = a;
    runs[a].area += runs[b].area;
}

// Unites the runs of a row with those of the row above that touch them and have the same value.
// Every second run has the same value. Background comes first, possibly empty.
void join_with_row_above(CleanScratch& scratch, std::size_t y) {
    Run* const runs = scratch.runs.data();
    const std::uint32_t above_first = scratch.first_run_of_row[y - 1];
    const std::uint32_t here_first = scratch.first_run_of_row[y];
    const std::uint32_t here_end = scratch.first_run_of_row[y + 1];
    // `reach` 1 also joins diagonal neighbours
    const auto join = [&](std::uint32_t above, std::uint32_t here, int reach) {
        while (above < here_first && here < here_end) {
            const int a_end = runs[above].end;
            const int b_end = runs[here].end;
            if (runs[above].begin < b_end + reach && runs[here].begin < a_end + reach)
                unite(runs, above, here);
            if (a_end < b_end)
                above += 2;
            else
                here += 2;
        }
    };
    join(above_first + (runs[above_first].end == 0 ? 2 : 0),
         here_first + (runs[here_first].end == 0 ? 2 : 0),
         1);
    join(above_first + 1, here_first + 1, 0);
}

}  // namespace

void majority_3x3(const ThreeRows& in,
                  InstructionSet instructions,
                  CleanScratch& scratch,
                  std::uint8_t* out) {
    scratch.column_votes.resize(static_cast<std::size_t>(in.width) + 2);
#if defined(__x86_64__)
    if (instructions == InstructionSet::kAvx2 && in.width >= 32)
        return majority_avx2(in, scratch.column_votes.data(), out);
#endif
    majority_baseline(in, scratch.column_votes.data(), out);
}

void start_runs(CleanScratch& scratch) {
    scratch.runs.clear();
    scratch.first_run_of_row.assign(1, 0);
}

// Runs alternate, and the first is background and may be empty: the parity within the row gives the
// value. Each run ends where a pixel differs from the previous one.
void add_runs(const std::uint8_t* row,
              int width,
              const image::PixelSpan& span,
              CleanScratch& scratch) {
    std::vector<Run>& runs = scratch.runs;
    auto index = static_cast<std::uint32_t>(runs.size());
    int begin = 0;
    const auto end_run = [&](int x) {
        runs.push_back({begin, x, index++, static_cast<std::uint32_t>(x - begin)});
        begin = x;
    };
    std::uint64_t before = 0;
    int x = span.begin;
    const auto add_bits = [&](std::uint64_t bits, int num) {
        for (std::uint64_t changes = bits ^ (bits << 1 | before); changes != 0;
             changes &= changes - 1) {
            const int bit = std::countr_zero(changes);
            if (bit == num) break;  // an artefact of the shift
            end_run(x + bit);
        }
        before = bits >> (num - 1);
        x += num;
    };
    while (x + 64 <= span.end)
        add_bits(bits_of(row + x) | static_cast<std::uint64_t>(bits_of(row + x + 32)) << 32, 64);
    if (x + 32 <= span.end) add_bits(bits_of(row + x), 32);
    for (; x < span.end; ++x) {
        const std::uint64_t bit = row[x] & 1;
        if (bit != before) end_run(x);
        before = bit;
    }
    if (before != 0 && x < width) end_run(x);
    end_run(width);
    scratch.first_run_of_row.push_back(index);
}

namespace {

// Calls `flip(y, run, is_background)` for each run of a part that is too small.
template <typename Flip>
void find_small_runs(
    std::size_t height, int min_area_px, int max_hole_px, CleanScratch& scratch, Flip&& flip) {
    for (std::size_t y = 1; y < height; ++y) join_with_row_above(scratch, y);
    const std::array<std::uint32_t, 2> least{static_cast<std::uint32_t>(std::max(max_hole_px, 0)),
                                             static_cast<std::uint32_t>(std::max(min_area_px, 0))};
    for (std::size_t y = 0; y < height; ++y) {
        const std::uint32_t first = scratch.first_run_of_row[y];
        for (std::uint32_t i = first; i < scratch.first_run_of_row[y + 1]; ++i) {
            const std::uint32_t parity = (i - first) % 2;
            // a run comes after its parent, which already points at the first run
            Run& run = scratch.runs[i];
            run.component = scratch.runs[run.component].component;
            if (scratch.runs[run.component].area < least[parity]) flip(y, run, parity == 0);
        }
    }
}

}  // namespace

void remove_small_runs(image::SparseMask& mask,
                       int min_area_px,
                       int max_hole_px,
                       CleanScratch& scratch) {
    find_small_runs(static_cast<std::size_t>(mask.mask.height),
                    min_area_px,
                    max_hole_px,
                    scratch,
                    [&](std::size_t y, const Run& run, bool is_background) {
                        if (run.begin == run.end) return;
                        std::uint8_t* const row = mask.mask.row(static_cast<int>(y));
                        std::fill(row + run.begin, row + run.end, is_background ? 255 : 0);
                        if (!is_background) return;
                        image::PixelSpan& span = mask.rows[y];
                        if (span.begin == span.end) span = {run.begin, run.end};
                        span = {std::min(span.begin, run.begin), std::max(span.end, run.end)};
                    });
}

}  // namespace atrium::segmentation
