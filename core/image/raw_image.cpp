#include "core/image/raw_image.hpp"

#include "core/image/colour_rows.hpp"

#include <algorithm>
#include <cassert>

namespace atrium::image {
namespace {

void yuv_of_packed(const PlaneView& pixels, bool blue_first, const PixelRect& part, YuvImage& out) {
    const RowCode code = best_row_code();
    for (int y = part.y; y < part.y + part.height; y += 2) {
        yuv_of_packed_rows(
            {pixels.row(y) + 3 * part.x, pixels.row(y + 1) + 3 * part.x, part.width, blue_first},
            {out.y.row(y) + part.x,
             out.y.row(y + 1) + part.x,
             out.u.row(y / 2) + part.x / 2,
             out.v.row(y / 2) + part.x / 2},
            code);
    }
}

void chroma_of_mosaic(const PlaneView& samples,
                      Mosaic mosaic,
                      const PixelRect& part,
                      YuvImage& out) {
    const RedAt red = red_at(mosaic);
    const RowCode code = best_row_code();
    for (int y = part.y; y < part.y + part.height; y += 2) {
        chroma_of_mosaic_rows({samples.row(y + red.y) + part.x,
                               samples.row(y + 1 - red.y) + part.x,
                               part.width / 2,
                               red.x},
                              out.u.row(y / 2) + part.x / 2,
                              out.v.row(y / 2) + part.x / 2,
                              code);
    }
}

// kLuma: position of the luma in each pair of bytes.
template <int kLuma>
void unpack_422(const PlaneView& packed, const PixelRect& part, YuvImage& out) {
    const int width = part.width;  // copy: the compiler must assume that writes change `part`
    for (int y = part.y; y < part.y + part.height; y += 2) {
        const std::uint8_t* __restrict top = packed.row(y) + 2 * part.x;
        const std::uint8_t* __restrict bottom = packed.row(y + 1) + 2 * part.x;
        std::uint8_t* __restrict top_luma = out.y.row(y) + part.x;
        std::uint8_t* __restrict bottom_luma = out.y.row(y + 1) + part.x;
        for (int x = 0; x < width; ++x) {
            top_luma[x] = top[2 * x + kLuma];
            bottom_luma[x] = bottom[2 * x + kLuma];
        }
        std::uint8_t* __restrict u = out.u.row(y / 2) + part.x / 2;
        std::uint8_t* __restrict v = out.v.row(y / 2) + part.x / 2;
        for (int x = 0; x < width / 2; ++x) {
            constexpr int kU = 1 - kLuma;
            u[x] = static_cast<std::uint8_t>((top[4 * x + kU] + bottom[4 * x + kU] + 1) / 2);
            v[x] =
                static_cast<std::uint8_t>((top[4 * x + kU + 2] + bottom[4 * x + kU + 2] + 1) / 2);
        }
    }
}

}  // namespace

std::size_t row_bytes(PixelFormat format, int width) {
    const auto w = static_cast<std::size_t>(width);
    switch (format) {
        case PixelFormat::kRgb:
        case PixelFormat::kBgr:
            return 3 * w;
        case PixelFormat::kUyvy:
        case PixelFormat::kYuyv:
            return 4 * ((w + 1) / 2);
        default:
            return w;
    }
}

Mosaic mosaic_of(PixelFormat format) {
    switch (format) {
        case PixelFormat::kBayerRG:
            return Mosaic::kRG;
        case PixelFormat::kBayerGR:
            return Mosaic::kGR;
        case PixelFormat::kBayerGB:
            return Mosaic::kGB;
        case PixelFormat::kBayerBG:
            return Mosaic::kBG;
        default:
            return Mosaic::kNone;
    }
}

RawImage::RawImage(std::shared_ptr<const YuvImage> image) {
    if (image == nullptr) return;
    width = image->width();
    height = image->height();
    const std::array<const Plane*, 3> sources{&image->y, &image->u, &image->v};
    for (std::size_t p = 0; p < 3; ++p)
        planes[p] = {sources[p]->data.data(), static_cast<std::size_t>(sources[p]->width)};
    owner = std::move(image);
}

WorkingPicture::WorkingPicture(const RawImage& raw, YuvImage& buffer) : format_(raw.format) {
    assert(!raw.empty());
    const int width = raw.width & ~1;
    const int height = raw.height & ~1;
    const auto plane = [&](std::size_t p, int w, int h) {
        return PlaneView(
            w, h, static_cast<std::ptrdiff_t>(raw.planes[p].stride_bytes), raw.planes[p].data);
    };
    source_ = plane(0, width, height);
    if (format_ == PixelFormat::kYuv420) {
        view_.y = source_;
        view_.u = plane(1, width / 2, height / 2);
        view_.v = plane(2, width / 2, height / 2);
        return;
    }
    resize(buffer.u, width / 2, height / 2);
    resize(buffer.v, width / 2, height / 2);
    view_.u = buffer.u;
    view_.v = buffer.v;
    if (format_ == PixelFormat::kMono8) {
        for (Plane* chroma : {&buffer.u, &buffer.v})
            std::fill(chroma->data.begin(), chroma->data.end(), 128);
        view_.y = source_;
        return;
    }
    buffer_ = &buffer;
    view_.mosaic = mosaic_of(format_);
    if (view_.mosaic != Mosaic::kNone) {
        view_.y = source_;
    } else {
        resize(buffer.y, width, height);
        view_.y = buffer.y;
    }
}

void WorkingPicture::make(const PixelRect& part) {
    assert(part.x >= 0 && part.y >= 0);
    assert(part.x + part.width <= view_.width() && part.y + part.height <= view_.height());
    assert((part.x | part.y | part.width | part.height) % 2 == 0);
    if (buffer_ == nullptr) return;
    switch (format_) {
        case PixelFormat::kRgb:
        case PixelFormat::kBgr:
            return yuv_of_packed(source_, format_ == PixelFormat::kBgr, part, *buffer_);
        case PixelFormat::kUyvy:
            return unpack_422<1>(source_, part, *buffer_);
        case PixelFormat::kYuyv:
            return unpack_422<0>(source_, part, *buffer_);
        default:
            return chroma_of_mosaic(source_, view_.mosaic, part, *buffer_);
    }
}

YuvView working_view(const RawImage& raw, YuvImage& buffer) {
    WorkingPicture picture(raw, buffer);
    picture.make_all();
    return picture.view();
}

}  // namespace atrium::image
