#include "site_node/refine/luma_picture.hpp"

#include "core/image/block_luma.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace atrium::refine {
namespace {

std::size_t place_of(int x, int y, int width) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
}

void fill_taps(const std::vector<std::uint8_t>& luma, LumaPicture& out) {
    out.taps.resize(luma.size());
    for (int y = 0; y < out.height; ++y) {
        const std::uint8_t* here = luma.data() + place_of(0, y, out.width);
        const std::uint8_t* below =
            luma.data() + place_of(0, std::min(y + 1, out.height - 1), out.width);
        std::uint32_t* to = out.taps.data() + place_of(0, y, out.width);
        for (int x = 0; x < out.width; ++x) {
            const int right = std::min(x + 1, out.width - 1);
            to[x] = std::uint32_t{here[x]} | (std::uint32_t{here[right]} << 8U) |
                    (std::uint32_t{below[x]} << 16U) | (std::uint32_t{below[right]} << 24U);
        }
    }
}

// Erodes the mask by a square, first along the rows.
void fill_inside(const image::Mask& mask, LumaScratch& scratch, LumaPicture& out) {
    constexpr int kReach = LumaPicture::kReach;
    const std::size_t size = out.taps.size();
    scratch.luma.assign(size, 0);  // of no more use: the mask of blocks
    for (int y = 0; y < out.height; ++y) {
        const std::uint8_t* top = mask.row(2 * (out.first_y + y)) + 2 * out.first_x;
        const std::uint8_t* bottom = top + mask.width;
        std::uint8_t* to = scratch.luma.data() + place_of(0, y, out.width);
        for (int x = 0; x < out.width; ++x)
            to[x] = top[2 * x] & top[2 * x + 1] & bottom[2 * x] & bottom[2 * x + 1] & 1U;
    }
    scratch.across.assign(size, 0);
    for (int y = 0; y < out.height; ++y) {
        const std::uint8_t* from = scratch.luma.data() + place_of(0, y, out.width);
        std::uint8_t* to = scratch.across.data() + place_of(0, y, out.width);
        for (int x = kReach; x < out.width - kReach; ++x)
            to[x] = from[x - 2] & from[x - 1] & from[x] & from[x + 1] & from[x + 2];
    }
    out.inside.assign(size, 0);
    for (int y = kReach; y < out.height - kReach; ++y) {
        const std::uint8_t* from = scratch.across.data() + place_of(0, y - kReach, out.width);
        std::uint8_t* to = out.inside.data() + place_of(0, y, out.width);
        const std::ptrdiff_t row = out.width;
        for (int x = 0; x < out.width; ++x)
            to[x] =
                from[x] & from[x + row] & from[x + 2 * row] & from[x + 3 * row] & from[x + 4 * row];
    }
}

}  // namespace

void fill(const PictureView& view, LumaScratch& scratch, LumaPicture& out, image::RowCode code) {
    static_assert(LumaPicture::kReach == 2);
    out.width = out.height = 0;
    out.taps.clear();
    out.inside.clear();
    const image::YuvView& picture = view.picture;
    if (picture.y.data == nullptr || view.mask == nullptr || view.subject.empty()) return;
    assert(view.mask->width >= picture.width() && view.mask->height >= picture.height());
    const int end_x = std::min(view.subject.x + view.subject.width + 1, picture.width()) / 2;
    const int end_y = std::min(view.subject.y + view.subject.height + 1, picture.height()) / 2;
    out.first_x = std::max(view.subject.x, 0) / 2;
    out.first_y = std::max(view.subject.y, 0) / 2;
    if (end_x <= out.first_x || end_y <= out.first_y) return;
    out.width = end_x - out.first_x;
    out.height = end_y - out.first_y;
    scratch.luma.resize(place_of(0, out.height, out.width));
    for (int y = 0; y < out.height; ++y) {
        image::luma_of_blocks(picture,
                              {2 * out.first_x, 2 * (out.first_y + y), out.width},
                              code,
                              scratch.luma.data() + place_of(0, y, out.width));
    }
    fill_taps(scratch.luma, out);
    fill_inside(*view.mask, scratch, out);
}

}  // namespace atrium::refine
