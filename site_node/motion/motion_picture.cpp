#include "site_node/motion/motion_picture.hpp"

#include <algorithm>
#include <cassert>

namespace atrium::motion {
namespace {

int floor_div(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

}  // namespace

void reduce(const codec::TextureCrop& crop, MotionPicture& out) {
    out.rect = {};
    if (crop.width() == 0 || crop.height() == 0) return;
    const int divisor = crop.crop_px.width / crop.width();  // of the crop: 1 or 2
    assert(divisor == 1 || divisor == 2);
    const int step = kMotionDivisor / divisor;  // pixels of the crop per pixel
    const int left = crop.crop_px.x / divisor;
    const int top = crop.crop_px.y / divisor;
    const int x0 = floor_div(left, step);
    const int y0 = floor_div(top, step);
    const int x1 = floor_div(left + crop.width() - 1, step) + 1;
    const int y1 = floor_div(top + crop.height() - 1, step) + 1;
    out.rect = {x0, y0, x1 - x0, y1 - y0};
    image::resize(out.luma, out.rect.width, out.rect.height);
    image::resize(out.mask, out.rect.width, out.rect.height);
    for (int y = 0; y < out.rect.height; ++y) {
        const int row0 = std::max(0, (y0 + y) * step - top);
        const int row1 = std::min(crop.height(), (y0 + y + 1) * step - top);
        for (int x = 0; x < out.rect.width; ++x) {
            const int column0 = std::max(0, (x0 + x) * step - left);
            const int column1 = std::min(crop.width(), (x0 + x + 1) * step - left);
            int all = 0, num = 0, inside = 0, num_inside = 0;
            for (int j = row0; j < row1; ++j) {
                for (int i = column0; i < column1; ++i) {
                    const int value = crop.y.at(i, j);
                    const int shows = crop.mask.at(i, j) != 0 ? 1 : 0;
                    all += value;
                    inside += shows * value;
                    num_inside += shows;
                    ++num;
                }
            }
            // of pixels at the outline, only the subject's part
            const int sum = num_inside > 0 ? inside : all;
            const int count = num_inside > 0 ? num_inside : num;
            out.luma.row(y)[x] = static_cast<std::uint8_t>((sum + count / 2) / count);
            out.mask.row(y)[x] = 2 * num_inside >= step * step ? 255 : 0;
        }
    }
}

void copy_part(const MotionPicture& picture, const image::PixelRect& rect, image::Plane& out) {
    image::resize(out, rect.width, rect.height);
    const int width = picture.rect.width;
    const int first = std::clamp(picture.rect.x - rect.x, 0, rect.width);
    const int last = std::clamp(picture.rect.x + width - rect.x, first, rect.width);
    for (int y = 0; y < rect.height; ++y) {
        const std::uint8_t* from =
            picture.luma.row(std::clamp(rect.y + y - picture.rect.y, 0, picture.rect.height - 1));
        std::uint8_t* to = out.row(y);
        std::fill(to, to + first, from[0]);
        std::copy(from + (rect.x + first - picture.rect.x),
                  from + (rect.x + last - picture.rect.x),
                  to + first);
        std::fill(to + last, to + rect.width, from[width - 1]);
    }
}

}  // namespace atrium::motion
