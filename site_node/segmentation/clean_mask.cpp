#include "site_node/segmentation/clean_mask.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace atrium::segmentation {
namespace {

using Run = CleanScratch::Run;

std::uint64_t load8(const std::uint8_t* bytes) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    return word;
}

// First column from `x` on that differs from `value`.
int end_of_run(const std::uint8_t* row, int x, int width, std::uint8_t value) {
    const std::uint64_t pattern = 0x0101010101010101ULL * value;
    for (; x + 32 <= width; x += 32) {
        const std::uint64_t first = (load8(row + x) ^ pattern) | (load8(row + x + 8) ^ pattern);
        const std::uint64_t second =
            (load8(row + x + 16) ^ pattern) | (load8(row + x + 24) ^ pattern);
        if ((first | second) != 0) break;
    }
    for (; x + 8 <= width; x += 8) {
        const std::uint64_t difference = load8(row + x) ^ pattern;
        if (difference != 0) return x + __builtin_ctzll(difference) / 8;
    }
    while (x < width && row[x] == value) ++x;
    return x;
}

// Foreground is -1 as a signed byte, so votes are counted below zero.
inline __attribute__((always_inline)) void majority(const ThreeRows& in,
                                                    CleanScratch& scratch,
                                                    std::uint8_t* __restrict result) {
    const auto width = static_cast<std::size_t>(in.width);
    const std::uint8_t* __restrict above = in.above;
    const std::uint8_t* __restrict here = in.here;
    const std::uint8_t* __restrict below = in.below;
    std::int8_t* __restrict votes = scratch.column_votes.data();
    std::int8_t any = 0;
    for (std::size_t x = 0; x < width; ++x) {
        const auto sum = static_cast<std::int8_t>(above[x] + here[x] + below[x]);
        votes[x + 1] = sum;
        any = static_cast<std::int8_t>(any | sum);
    }
    if (any == 0) {
        std::memset(result, 0, width);
        return;
    }
    votes[0] = votes[1];
    votes[width + 1] = votes[width];
    for (std::size_t x = 0; x < width; ++x) {
        const auto sum = static_cast<std::int8_t>(votes[x] + votes[x + 1] + votes[x + 2]);
        result[x] = sum <= -5 ? 255 : 0;
    }
}

void majority_baseline(const ThreeRows& in, CleanScratch& scratch, std::uint8_t* out) {
    majority(in, scratch, out);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void majority_avx2(const ThreeRows& in,
                                                   CleanScratch& scratch,
                                                   std::uint8_t* out) {
    majority(in, scratch, out);
}
#endif

std::uint32_t find(std::vector<Run>& runs, std::uint32_t i) {
    while (runs[i].component != i) {
        runs[i].component = runs[runs[i].component].component;
        i = runs[i].component;
    }
    return i;
}

void unite(std::vector<Run>& runs, std::uint32_t a, std::uint32_t b) {
    a = find(runs, a);
    b = find(runs, b);
    if (a == b) return;
    if (b < a) std::swap(a, b);
    runs[b].component = a;
    runs[a].area += runs[b].area;
}

// Joins the runs of one value, which is every second one, with those of the row above that they
// touch. `reach` 1 also joins diagonal neighbours.
void join_with_row_above(CleanScratch& scratch, std::size_t y, std::uint32_t parity, int reach) {
    std::vector<Run>& runs = scratch.runs;
    std::uint32_t above = scratch.first_run_of_row[y - 1] + parity;
    std::uint32_t here = scratch.first_run_of_row[y] + parity;
    const std::uint32_t above_end = scratch.first_run_of_row[y];
    const std::uint32_t here_end = scratch.first_run_of_row[y + 1];
    while (above < above_end && here < here_end) {
        const Run& a = runs[above];
        const Run& b = runs[here];
        const bool empty = a.begin == a.end || b.begin == b.end;
        const int a_end = a.end;
        const int b_end = b.end;
        if (!empty && a.begin < b_end + reach && b.begin < a_end + reach) unite(runs, above, here);
        (a_end < b_end ? above : here) += 2;
    }
}

}  // namespace

void majority_3x3(const ThreeRows& in,
                  InstructionSet instructions,
                  CleanScratch& scratch,
                  std::uint8_t* out) {
    scratch.column_votes.resize(static_cast<std::size_t>(in.width) + 2);
#if defined(__x86_64__)
    if (instructions == InstructionSet::kAvx2) return majority_avx2(in, scratch, out);
#endif
    majority_baseline(in, scratch, out);
}

void majority_3x3(const image::Mask& in, CleanScratch& scratch, image::Mask& out) {
    if (out.width != in.width || out.height != in.height) out = image::Mask(in.width, in.height);
    if (in.data.empty()) return;
    const InstructionSet instructions = best_instruction_set();
    for (int y = 0; y < in.height; ++y) {
        majority_3x3({in.row(std::max(y - 1, 0)),
                      in.row(y),
                      in.row(std::min(y + 1, in.height - 1)),
                      in.width},
                     instructions,
                     scratch,
                     out.row(y));
    }
}

void start_runs(CleanScratch& scratch) {
    scratch.runs.clear();
    scratch.first_run_of_row.assign(1, 0);
}

// Runs alternate; the first one is background and may be empty. So parity within the row tells the
// value.
void add_runs(const std::uint8_t* row, int width, CleanScratch& scratch) {
    std::uint8_t value = 0;
    for (int x = 0; x < width; value = static_cast<std::uint8_t>(~value)) {
        const int end = end_of_run(row, x, width, value);
        scratch.runs.push_back({x,
                                end,
                                static_cast<std::uint32_t>(scratch.runs.size()),
                                static_cast<std::uint32_t>(end - x)});
        x = end;
    }
    scratch.first_run_of_row.push_back(static_cast<std::uint32_t>(scratch.runs.size()));
}

void remove_small_parts(image::Mask& mask,
                        int min_area_px,
                        int max_hole_px,
                        CleanScratch& scratch) {
    if (min_area_px <= 1 && max_hole_px <= 1) return;
    start_runs(scratch);
    for (int y = 0; y < mask.height; ++y) add_runs(mask.row(y), mask.width, scratch);
    remove_small_runs(mask, min_area_px, max_hole_px, scratch);
}

void remove_small_runs(image::Mask& mask, int min_area_px, int max_hole_px, CleanScratch& scratch) {
    const auto height = static_cast<std::size_t>(mask.height);
    for (std::size_t y = 1; y < height; ++y) {
        join_with_row_above(scratch, y, 0, 1);
        join_with_row_above(scratch, y, 1, 0);
    }
    const std::array<std::uint32_t, 2> least{static_cast<std::uint32_t>(std::max(max_hole_px, 0)),
                                             static_cast<std::uint32_t>(std::max(min_area_px, 0))};
    for (std::size_t y = 0; y < height; ++y) {
        const std::uint32_t first = scratch.first_run_of_row[y];
        for (std::uint32_t i = first; i < scratch.first_run_of_row[y + 1]; ++i) {
            const Run& run = scratch.runs[i];
            const std::uint32_t parity = (i - first) % 2;
            if (scratch.runs[find(scratch.runs, i)].area >= least[parity]) continue;
            std::fill(mask.row(static_cast<int>(y)) + run.begin,
                      mask.row(static_cast<int>(y)) + run.end,
                      parity == 0 ? 255 : 0);
        }
    }
}

}  // namespace atrium::segmentation
