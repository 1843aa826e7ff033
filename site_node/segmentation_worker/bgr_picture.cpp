#include "site_node/segmentation_worker/bgr_picture.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace atrium::segmentation_worker {
namespace {

constexpr int kRows = 16;  // converted at a time: they fit the cache

// Full-range BT.601, in 1/65536.
constexpr int kRedOfV = 91881, kGreenOfU = -22553, kGreenOfV = -46802, kBlueOfU = 116130;

int rounded(int value) { return (value + (1 << 15)) >> 16; }

int demosaicing_of(image::Mosaic mosaic) {
    switch (mosaic) {
        case image::Mosaic::kRG:
            return cv::COLOR_BayerRGGB2BGR;
        case image::Mosaic::kGR:
            return cv::COLOR_BayerGRBG2BGR;
        case image::Mosaic::kGB:
            return cv::COLOR_BayerGBRG2BGR;
        case image::Mosaic::kBG:
        case image::Mosaic::kNone:
            break;
    }
    return cv::COLOR_BayerBGGR2BGR;
}

cv::Mat view_of(const image::PlaneView& plane) {
    auto* first = const_cast<std::uint8_t*>(plane.data);
    return {
        plane.height, plane.width, CV_8UC1, first, static_cast<std::size_t>(plane.stride_bytes)};
}

// What the chroma of a row of blocks adds to the luma of each of their pixels.
void add_of_chroma(const std::uint8_t* u, const std::uint8_t* v, int width, std::int16_t* out) {
    std::int16_t* const blue = out;
    std::int16_t* const green = out + width;
    std::int16_t* const red = out + std::ptrdiff_t{2} * width;
    for (int block = 0; block < width / 2; ++block) {
        const int cb = u[block] - 128;
        const int cr = v[block] - 128;
        const auto b = static_cast<std::int16_t>(rounded(kBlueOfU * cb));
        const auto g = static_cast<std::int16_t>(rounded(kGreenOfU * cb + kGreenOfV * cr));
        const auto r = static_cast<std::int16_t>(rounded(kRedOfV * cr));
        blue[2 * block] = blue[2 * block + 1] = b;
        green[2 * block] = green[2 * block + 1] = g;
        red[2 * block] = red[2 * block + 1] = r;
    }
}

void add_to_luma(const std::uint8_t* __restrict luma,
                 const std::int16_t* __restrict add,
                 int width,
                 std::uint8_t* __restrict out) {
    for (int x = 0; x < width; ++x) {
        const auto sum = static_cast<std::int16_t>(luma[x] + add[x]);
        const std::int16_t most = std::min<std::int16_t>(sum, 255);
        out[x] = static_cast<std::uint8_t>(std::max<std::int16_t>(most, 0));
    }
}

void copy_packed(const image::RawImage& raw,
                 const image::YuvView& working,
                 const GiveWay& give_way,
                 std::uint8_t* out) {
    const auto row_bytes = static_cast<std::size_t>(working.width()) * 3;
    for (int y = 0; y < working.height(); ++y) {
        const std::uint8_t* const from =
            raw.planes[0].data + static_cast<std::size_t>(y) * raw.planes[0].stride_bytes;
        std::copy_n(from, row_bytes, out + static_cast<std::size_t>(y) * row_bytes);
        if (y % kRows == kRows - 1) give_way();
    }
}

}  // namespace

void BgrPicture::write(const image::RawImage& raw,
                       const image::YuvView& working,
                       const GiveWay& give_way,
                       std::uint8_t* out) {
    if (raw.format == image::PixelFormat::kBgr) return copy_packed(raw, working, give_way, out);
    write_yuv(working, give_way, out);
}

void BgrPicture::write(const segmentation::BackgroundModel& model,
                       const GiveWay& give_way,
                       std::uint8_t* out) {
    const int width = model.width();
    const int height = model.height();
    image::resize(background_.y, width, height);
    image::resize(background_.u, width / 2, height / 2);
    image::resize(background_.v, width / 2, height / 2);
    std::ranges::transform(model.luma, background_.y.data.begin(), [](std::uint16_t mean) {
        return static_cast<std::uint8_t>(std::min((mean + 128) >> 8, 255));
    });
    const auto chroma = [](std::int16_t mean) {
        return static_cast<std::uint8_t>(std::clamp(((mean + 64) >> 7) + 128, 0, 255));
    };
    std::ranges::transform(model.u, background_.u.data.begin(), chroma);
    std::ranges::transform(model.v, background_.v.data.begin(), chroma);
    image::YuvView view(background_);
    view.mosaic = model.room.mosaic;
    write_yuv(view, give_way, out);
}

void BgrPicture::write_yuv(const image::YuvView& picture,
                           const GiveWay& give_way,
                           std::uint8_t* out) {
    const int width = picture.width();
    const int height = picture.height();
    if (picture.mosaic != image::Mosaic::kNone) {
        cv::Mat bgr(height, width, CV_8UC3, out);
        cv::cvtColor(view_of(picture.y), bgr, demosaicing_of(picture.mosaic));
        return;
    }
    const auto row = static_cast<std::size_t>(width);
    chroma_.resize(3 * row);
    colours_.resize(3 * row * kRows);
    for (int begin = 0; begin < height; begin += kRows) {
        const int num_rows = std::min(kRows, height - begin);
        std::array<cv::Mat, 3> planes;
        for (std::size_t colour = 0; colour < 3; ++colour)
            planes[colour] =
                cv::Mat(num_rows, width, CV_8UC1, colours_.data() + colour * row * kRows);
        for (int y = 0; y < num_rows; ++y) {
            const int block_row = (begin + y) / 2;
            if (y % 2 == 0)
                add_of_chroma(
                    picture.u.row(block_row), picture.v.row(block_row), width, chroma_.data());
            for (std::size_t colour = 0; colour < 3; ++colour)
                add_to_luma(picture.y.row(begin + y),
                            chroma_.data() + colour * row,
                            width,
                            planes[colour].ptr(y));
        }
        cv::Mat bgr(num_rows, width, CV_8UC3, out + 3 * row * static_cast<std::size_t>(begin));
        cv::merge(planes.data(), planes.size(), bgr);
        give_way();
    }
}

}  // namespace atrium::segmentation_worker
