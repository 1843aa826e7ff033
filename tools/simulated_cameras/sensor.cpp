#include "tools/simulated_cameras/sensor.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

namespace atrium::simulated_cameras {
namespace {

using image::PixelFormat;

constexpr std::array<std::pair<const char*, PixelFormat>, 6> kFormats{
    {{"BayerRG8", PixelFormat::kBayerRG},
     {"BayerGR8", PixelFormat::kBayerGR},
     {"BayerGB8", PixelFormat::kBayerGB},
     {"BayerBG8", PixelFormat::kBayerBG},
     {"Mono8", PixelFormat::kMono8},
     {"RGB8", PixelFormat::kRgb}}};

// Differences of red, green and blue from luma, in full-range BT.601.
struct ColourOffsets {
    int red = 0;
    int green = 0;
    int blue = 0;
};

ColourOffsets offsets_of(int u, int v) {
    constexpr int kHalf = 1 << 15;  // 16 bits of fraction
    const int cb = u - 128;
    const int cr = v - 128;
    return {(91881 * cr + kHalf) >> 16,
            (-22554 * cb - 46802 * cr + kHalf) >> 16,
            (116130 * cb + kHalf) >> 16};
}

std::uint8_t to_byte(int value) { return static_cast<std::uint8_t>(std::clamp(value, 0, 255)); }

void sense_mosaic(const image::YuvView& picture,
                  image::RedAt red_at,
                  std::vector<std::uint8_t>& out) {
    const int width = picture.width();
    for (int y = 0; y < picture.height(); ++y) {
        const std::uint8_t* luma = picture.y.row(y);
        const std::uint8_t* u = picture.u.row(y / 2);
        const std::uint8_t* v = picture.v.row(y / 2);
        std::uint8_t* row = out.data() + static_cast<std::ptrdiff_t>(y) * width;
        const bool is_red_row = (y & 1) == red_at.y;
        for (int x = 0; x < width; ++x) {
            const ColourOffsets offsets = offsets_of(u[x / 2], v[x / 2]);
            const bool is_red_column = (x & 1) == red_at.x;
            const int offset = is_red_row == is_red_column
                                   ? (is_red_row ? offsets.red : offsets.blue)
                                   : offsets.green;
            row[x] = to_byte(luma[x] + offset);
        }
    }
}

void sense_rgb(const image::YuvView& picture, std::vector<std::uint8_t>& out) {
    std::uint8_t* pixel = out.data();
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x, pixel += 3) {
            const int luma = picture.y.at(x, y);
            const ColourOffsets offsets =
                offsets_of(picture.u.at(x / 2, y / 2), picture.v.at(x / 2, y / 2));
            pixel[0] = to_byte(luma + offsets.red);
            pixel[1] = to_byte(luma + offsets.green);
            pixel[2] = to_byte(luma + offsets.blue);
        }
    }
}

}  // namespace

std::vector<std::string> pixel_format_names() {
    std::vector<std::string> names;
    for (const auto& [name, format] : kFormats) names.emplace_back(name);
    return names;
}

Expected<PixelFormat> find_pixel_format(std::string_view genicam_name) {
    for (const auto& [name, format] : kFormats) {
        if (name == genicam_name) return format;
    }
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("pixel format '{}': must be one of {}",
                                  genicam_name,
                                  fmt::join(pixel_format_names(), ", ")));
}

std::vector<std::uint8_t> sense(const image::YuvView& picture, PixelFormat format) {
    assert(picture.mosaic == image::Mosaic::kNone);
    const image::Mosaic mosaic = image::mosaic_of(format);
    std::vector<std::uint8_t> out(image::row_bytes(format, picture.width()) *
                                  static_cast<std::size_t>(picture.height()));
    if (mosaic != image::Mosaic::kNone) {
        sense_mosaic(picture, image::red_at(mosaic), out);
    } else if (format == PixelFormat::kRgb) {
        sense_rgb(picture, out);
    } else {
        assert(format == PixelFormat::kMono8);
        for (int y = 0; y < picture.height(); ++y) {
            std::copy_n(picture.y.row(y),
                        picture.width(),
                        out.begin() + static_cast<std::ptrdiff_t>(y) * picture.width());
        }
    }
    return out;
}

}  // namespace atrium::simulated_cameras
