#include "core/image/raw_image.hpp"

#include "core/image/colour_rows.hpp"

#include <algorithm>
#include <cassert>

namespace atrium::image {
namespace {

void resize(Plane& plane, int width, int height) {
    if (plane.width == width && plane.height == height) return;
    plane = Plane(width, height);
}

void chroma_of_mosaic(const PlaneView& samples, Mosaic mosaic, YuvImage& out) {
    const RedAt red = red_at(mosaic);
    const RowCode code = best_row_code();
    for (int y = 0; y < samples.height / 2; ++y) {
        chroma_of_mosaic_rows(
            {samples.row(2 * y + red.y), samples.row(2 * y + 1 - red.y), samples.width / 2, red.x},
            out.u.row(y),
            out.v.row(y),
            code);
    }
}

// kLuma: where in a pair of bytes the luma is.
template <int kLuma>
void unpack_422(const PlaneView& packed, int width, int height, YuvImage& out) {
    for (int y = 0; y < height; y += 2) {
        const std::uint8_t* __restrict top = packed.row(y);
        const std::uint8_t* __restrict bottom = packed.row(y + 1);
        std::uint8_t* __restrict top_luma = out.y.row(y);
        std::uint8_t* __restrict bottom_luma = out.y.row(y + 1);
        for (int x = 0; x < width; ++x) {
            top_luma[x] = top[2 * x + kLuma];
            bottom_luma[x] = bottom[2 * x + kLuma];
        }
        std::uint8_t* __restrict u = out.u.row(y / 2);
        std::uint8_t* __restrict v = out.v.row(y / 2);
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

YuvView working_view(const RawImage& raw, YuvImage& buffer) {
    assert(!raw.empty());
    const int width = raw.width & ~1;
    const int height = raw.height & ~1;
    const auto plane = [&](std::size_t p, int w, int h) {
        return PlaneView(
            w, h, static_cast<std::ptrdiff_t>(raw.planes[p].stride_bytes), raw.planes[p].data);
    };
    const PlaneView first = plane(0, width, height);
    if (raw.format == PixelFormat::kRgb || raw.format == PixelFormat::kBgr) {
        auto* const convert = raw.format == PixelFormat::kRgb ? yuv_from_rgb : yuv_from_bgr;
        convert(first.data, width, height, raw.planes[0].stride_bytes, buffer);
        return buffer;
    }
    YuvView view;
    if (raw.format == PixelFormat::kYuv420) {
        view.y = first;
        view.u = plane(1, width / 2, height / 2);
        view.v = plane(2, width / 2, height / 2);
        return view;
    }
    if (raw.format == PixelFormat::kMono8) {
        for (Plane* chroma : {&buffer.u, &buffer.v}) {
            resize(*chroma, width / 2, height / 2);
            std::fill(chroma->data.begin(), chroma->data.end(), 128);
        }
        view = buffer;
        view.y = first;
        return view;
    }
    resize(buffer.u, width / 2, height / 2);
    resize(buffer.v, width / 2, height / 2);
    const Mosaic mosaic = mosaic_of(raw.format);
    if (mosaic != Mosaic::kNone) {
        chroma_of_mosaic(first, mosaic, buffer);
        view = buffer;
        view.y = first;
        view.mosaic = mosaic;
        return view;
    }
    resize(buffer.y, width, height);
    if (raw.format == PixelFormat::kUyvy) {
        unpack_422<1>(first, width, height, buffer);
    } else {
        unpack_422<0>(first, width, height, buffer);
    }
    return buffer;
}

}  // namespace atrium::image
