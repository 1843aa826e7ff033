#include "core/image/image.hpp"

#include "core/image/colour_rows.hpp"

namespace atrium::image {
void yuv_from_bgr(
    const std::uint8_t* bgr, int width, int height, std::size_t stride_bytes, YuvImage& out) {
    const int even_width = width & ~1;
    const int even_height = height & ~1;
    resize(out.y, even_width, even_height);
    resize(out.u, even_width / 2, even_height / 2);
    resize(out.v, even_width / 2, even_height / 2);
    const RowCode code = best_row_code();
    for (int y = 0; y < even_height; y += 2) {
        const std::uint8_t* top = bgr + static_cast<std::size_t>(y) * stride_bytes;
        yuv_of_packed_rows({top, top + stride_bytes, even_width, true},
                           {out.y.row(y), out.y.row(y + 1), out.u.row(y / 2), out.v.row(y / 2)},
                           code);
    }
}

}  // namespace atrium::image
