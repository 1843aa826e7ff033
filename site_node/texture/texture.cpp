#include "site_node/texture/texture.hpp"

#include "core/image/block_luma.hpp"
#include "site_node/texture/fill_background.hpp"
#include "site_node/texture/full_resolution.hpp"
#include "site_node/texture/outline_chroma.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <utility>

namespace atrium::texture {
namespace {

std::uint64_t load8(const std::uint8_t* bytes) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    return word;
}

// Returns the first column in [0, end) with foreground; `end` without any.
int first_foreground(const std::uint8_t* row, int end) {
    int x = 0;
    for (; x + 8 <= end; x += 8) {
        if (const std::uint64_t word = load8(row + x); word != 0)
            return x + std::countr_zero(word) / 8;
    }
    while (x < end && row[x] == 0) ++x;
    return x;
}

// Returns one past the last column in [begin, end) with foreground; `begin` without any.
int last_foreground(const std::uint8_t* row, int begin, int end) {
    for (; end - 8 >= begin; end -= 8) {
        if (const std::uint64_t word = load8(row + end - 8); word != 0)
            return end - std::countl_zero(word) / 8;
    }
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

// Sets `outline` where a block shows both the person and the background. Plain C++ for the compiler
// to vectorise, instantiated once per instruction set.
#define ATRIUM_INLINE inline __attribute__((always_inline))

ATRIUM_INLINE void vote_some(const std::uint8_t* __restrict top,
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

// The last step overlaps the one before it.
ATRIUM_INLINE void vote(const std::uint8_t* top,
                        const std::uint8_t* bottom,
                        int num_blocks,
                        std::uint8_t* alpha,
                        std::uint8_t* outline) {
    constexpr int kStep = 32;
    if (num_blocks < kStep) return vote_some(top, bottom, num_blocks, alpha, outline);
    for (int next = 0; next < num_blocks; next += kStep) {
        const int x = std::min(next, num_blocks - kStep);
        vote_some(top + 2 * x, bottom + 2 * x, kStep, alpha + x, outline + x);
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

// Returns the mean luma of the foreground pixels in the 2x2 block at (x, y).
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
        const std::uint8_t* const top = mask.row(crop.y + 2 * y) + crop.x;
        const std::uint8_t* const bottom = mask.row(crop.y + 2 * y + 1) + crop.x;
        // pixels outside the person are filled later
        int begin =
            std::min(first_foreground(top, crop.width), first_foreground(bottom, crop.width)) / 2;
        int end =
            (std::max(last_foreground(top, 0, crop.width), last_foreground(bottom, 0, crop.width)) +
             1) /
            2;
        std::uint8_t* const alpha = out.mask.row(y);
        if (begin >= end) begin = end = 0;
        std::fill(alpha, alpha + begin, std::uint8_t{0});
        std::fill(alpha + end, alpha + width, std::uint8_t{0});
        const int num = end - begin;
        const int x0 = crop.x / 2 + begin;
        std::copy_n(frame.u.row(crop.y / 2 + y) + x0, num, out.u.row(y) + begin);
        std::copy_n(frame.v.row(crop.y / 2 + y) + x0, num, out.v.row(y) + begin);
        image::luma_of_blocks(frame, {2 * x0, crop.y + 2 * y, num}, code, out.y.row(y) + begin);
        vote_row(top + 2 * begin, bottom + 2 * begin, num, alpha + begin, outline + begin);
        if (frame.mosaic != image::Mosaic::kNone) continue;
        for (int x = begin; (x += first_foreground(outline + x, end - x)) < end; ++x)
            out.y.row(y)[x] = foreground_luma(frame, mask, crop.x + 2 * x, crop.y + 2 * y);
    }
}

void copy_full(const image::YuvView& frame,
               const image::Mask& mask,
               const image::PixelRect& crop,
               codec::TextureCrop& out) {
    full_luma(frame, crop, out.y);
    full_chroma(frame.u, crop, out.u);
    full_chroma(frame.v, crop, out.v);
    for (int y = 0; y < crop.height; ++y)
        std::copy_n(mask.row(crop.y + y) + crop.x, crop.width, out.mask.row(y));
}

}  // namespace

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
        copy_full(frame, mask, crop, out);
    else
        halve(frame, mask, crop, code, scratch, out);
    clean_outline_chroma(frame, divisor, out);
    fill_background(out, code, scratch.blocks);
    return true;
}

}  // namespace atrium::texture
