#include "site_node/segmentation/pixel_test.hpp"

#include <algorithm>
#include <cassert>

// The loops are plain C++ that the compiler vectorises; each set of instructions is one more
// instance of the same source.

namespace atrium::segmentation {
namespace {

#define ATRIUM_INLINE inline __attribute__((always_inline))

struct BlockRow {
    const std::uint8_t* u;
    const std::uint8_t* v;
    const std::int16_t* ratio_u;
    const std::int16_t* ratio_v;
    const std::int16_t* whiten_u;
    const std::int16_t* whiten_uv;
    const std::int16_t* whiten_v;
};

// Rounded product with a factor in 1/32768.
ATRIUM_INLINE std::int16_t scaled(std::int16_t value, std::int16_t factor) {
    return static_cast<std::int16_t>((static_cast<std::int32_t>(value) * factor + (1 << 14)) >> 15);
}

ATRIUM_INLINE void sum_blocks(const std::uint8_t* __restrict top,
                              const std::uint8_t* __restrict bottom,
                              int num_blocks,
                              std::int16_t* __restrict sum) {
    for (int x = 0; x < num_blocks; ++x) {
        sum[x] = static_cast<std::int16_t>(top[2 * x] + top[2 * x + 1] + bottom[2 * x] +
                                           bottom[2 * x + 1]);
    }
}

ATRIUM_INLINE void test_chroma(const BlockRow& row,
                               const std::int16_t* __restrict luma_sum,
                               std::int32_t max_distance_sq,
                               int num_blocks,
                               std::uint8_t* __restrict verdict) {
    const std::uint8_t* __restrict u = row.u;
    const std::uint8_t* __restrict v = row.v;
    for (int x = 0; x < num_blocks; ++x) {
        // deviation from the scaled chroma, in quarters: the sum of four lumas, times 8, times a
        // ratio in 1/4096
        const auto luma = static_cast<std::int16_t>(luma_sum[x] * 8);
        const auto du = static_cast<std::int16_t>(4 * (u[x] - 128) - scaled(luma, row.ratio_u[x]));
        const auto dv = static_cast<std::int16_t>(4 * (v[x] - 128) - scaled(luma, row.ratio_v[x]));
        // in 1/64 of a deviation; far beyond any threshold at the clamp
        const auto du64 = static_cast<std::int16_t>(std::clamp<int>(du, -1023, 1023) * 16);
        const auto dv64 = static_cast<std::int16_t>(std::clamp<int>(dv, -1023, 1023) * 16);
        const std::int32_t a = scaled(du64, row.whiten_u[x]);
        const std::int32_t b = scaled(du64, row.whiten_uv[x]) + scaled(dv64, row.whiten_v[x]);
        const auto byte = static_cast<std::uint8_t>(a * a + b * b > max_distance_sq ? 255 : 0);
        verdict[2 * x] = byte;
        verdict[2 * x + 1] = byte;
    }
}

ATRIUM_INLINE void test_luma(const std::uint8_t* __restrict y,
                             const std::uint8_t* __restrict low,
                             const std::uint8_t* __restrict high,
                             const std::uint8_t* __restrict chroma_verdict,
                             int width,
                             std::uint8_t* __restrict out) {
    for (int x = 0; x < width; ++x) {
        const std::uint8_t outside = (y[x] < low[x]) | (y[x] > high[x]) ? 255 : 0;
        out[x] = outside | chroma_verdict[x];
    }
}

ATRIUM_INLINE void test_all(const image::YuvView& frame,
                            const BackgroundModel& model,
                            PixelTestScratch& scratch,
                            image::Mask& out) {
    const int width = model.width;
    const int num_blocks = width / 2;
    for (int y = 0; y < model.height; y += 2) {
        const std::ptrdiff_t block = static_cast<std::ptrdiff_t>(y / 2) * num_blocks;
        const BlockRow row{frame.u.row(y / 2),
                           frame.v.row(y / 2),
                           model.ratio_u.data() + block,
                           model.ratio_v.data() + block,
                           model.whiten_u.data() + block,
                           model.whiten_uv.data() + block,
                           model.whiten_v.data() + block};
        sum_blocks(frame.y.row(y), frame.y.row(y + 1), num_blocks, scratch.luma_sum.data());
        test_chroma(row,
                    scratch.luma_sum.data(),
                    model.max_distance_sq,
                    num_blocks,
                    scratch.chroma_verdict.data());
        for (int line = y; line < y + 2; ++line) {
            const std::ptrdiff_t pixel = static_cast<std::ptrdiff_t>(line) * width;
            test_luma(frame.y.row(line),
                      model.luma_low.data() + pixel,
                      model.luma_high.data() + pixel,
                      scratch.chroma_verdict.data(),
                      width,
                      out.row(line));
        }
    }
}

void test_baseline(const image::YuvView& frame,
                   const BackgroundModel& model,
                   PixelTestScratch& scratch,
                   image::Mask& out) {
    test_all(frame, model, scratch, out);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void test_avx2(const image::YuvView& frame,
                                               const BackgroundModel& model,
                                               PixelTestScratch& scratch,
                                               image::Mask& out) {
    test_all(frame, model, scratch, out);
}
#endif

#undef ATRIUM_INLINE

}  // namespace

InstructionSet best_instruction_set() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return InstructionSet::kAvx2;
#endif
    return InstructionSet::kBaseline;
}

void test_pixels(const image::YuvView& frame,
                 const BackgroundModel& model,
                 InstructionSet instructions,
                 PixelTestScratch& scratch,
                 image::Mask& out) {
    assert(frame.width() == model.width && frame.height() == model.height);
    assert(out.width == model.width && out.height == model.height);
    scratch.luma_sum.resize(static_cast<std::size_t>(model.width / 2));
    scratch.chroma_verdict.resize(static_cast<std::size_t>(model.width));
#if defined(__x86_64__)
    if (instructions == InstructionSet::kAvx2) return test_avx2(frame, model, scratch, out);
#endif
    test_baseline(frame, model, scratch, out);
}

}  // namespace atrium::segmentation
