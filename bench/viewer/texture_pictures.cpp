#include "bench/viewer/texture_pictures.hpp"

#include "bench/value_of.hpp"
#include "tests/support/pictures/camera_orbit.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <utility>

namespace atrium::bench {

using test::Photo;
using test::TruePicture;

void write_side_by_side(const std::filesystem::path& file,
                        const TruePicture& truth,
                        const std::vector<Photo>& photos) {
    int x0 = truth.width(), y0 = truth.height(), x1 = 0, y1 = 0;
    for (int y = 0; y < truth.height(); ++y) {
        for (int x = 0; x < truth.width(); ++x) {
            if (truth.mask.at(x, y) == 0) continue;
            x0 = std::min(x0, x);
            x1 = std::max(x1, x + 1);
            y0 = std::min(y0, y);
            y1 = std::max(y1, y + 1);
        }
    }
    constexpr int kMargin = 12;
    x0 = std::max(x0 - kMargin, 0);
    y0 = std::max(y0 - kMargin, 0);
    x1 = std::min(x1 + kMargin, truth.width());
    y1 = std::min(y1 + kMargin, truth.height());
    const cv::Rect part(x0, y0, x1 - x0, y1 - y0);
    std::vector<cv::Mat> panels;
    const auto add = [&](const std::vector<std::uint8_t>& bgr) {
        const cv::Mat whole(
            truth.height(), truth.width(), CV_8UC3, const_cast<std::uint8_t*>(bgr.data()));
        panels.push_back(whole(part).clone());
    };
    add(truth.bgr);
    for (const Photo& photo : photos) add(photo.bgr);
    cv::Mat row;
    cv::hconcat(panels, row);
    if (!cv::imwrite(file.string(), row)) fmt::print(stderr, "cannot write {}\n", file.string());
}

Photo enlarged(const renderer::CameraPicture& picture, int width, int height) {
    Photo photo{width, height, {}, image::Mask(width, height)};
    photo.bgr.assign(photo.opacity.data.size() * 3, 128);
    const cv::Mat rgba(
        picture.height, picture.width, CV_8UC4, const_cast<std::uint8_t*>(picture.rgba.data()));
    cv::Mat large;
    cv::resize(
        rgba, large, {picture.crop_px.width, picture.crop_px.height}, 0, 0, cv::INTER_LINEAR);
    for (int y = 0; y < large.rows; ++y) {
        for (int x = 0; x < large.cols; ++x) {
            const auto* from = large.ptr<std::uint8_t>(y) + static_cast<std::ptrdiff_t>(4) * x;
            const std::size_t to =
                static_cast<std::size_t>(y + picture.crop_px.y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x + picture.crop_px.x);
            photo.opacity.data[to] = 255;
            for (std::size_t c = 0; c < 3; ++c) photo.bgr[3 * to + c] = from[2 - c];
        }
    }
    return photo;
}

void show_person_alone(std::span<const geometry::CalibratedCamera> rig,
                       const simulation::RoomOptions& room,
                       double time_s,
                       std::vector<TruePicture>& pictures) {
    std::vector<geometry::CalibratedCamera> cameras;
    for (const TruePicture& picture : pictures) cameras.push_back(picture.camera);
    std::vector<Photo> photos = value_of(test::photograph_truth(rig, room, time_s, cameras));
    for (std::size_t i = 0; i < pictures.size(); ++i) pictures[i].bgr.swap(photos[i].bgr);
}

TruePicture halved(const TruePicture& from) {
    TruePicture out;
    out.camera = from.camera;
    auto& lens = out.camera.intrinsics;
    lens.width /= 2;
    lens.height /= 2;
    lens.fx /= 2;
    lens.fy /= 2;
    lens.skew /= 2;
    lens.cx = (lens.cx - 0.5) / 2;
    lens.cy = (lens.cy - 0.5) / 2;
    out.mask = image::Mask(lens.width, lens.height);
    out.bgr.resize(out.mask.data.size() * 3);
    for (int y = 0; y < lens.height; ++y) {
        for (int x = 0; x < lens.width; ++x) {
            std::array<int, 3> sum{};
            int votes = 0;
            for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
                if (from.mask.at(2 * x + dx, 2 * y + dy) == 0) continue;
                ++votes;
                const std::uint8_t* bgr =
                    from.bgr.data() +
                    3 * (static_cast<std::ptrdiff_t>(2 * y + dy) * from.width() + 2 * x + dx);
                for (std::size_t c = 0; c < 3; ++c) sum[c] += bgr[c];
            }
            const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(lens.width) +
                               static_cast<std::size_t>(x);
            out.mask.data[pixel] = votes >= 2 ? 255 : 0;
            for (std::size_t c = 0; c < 3 && votes > 0; ++c)
                out.bgr[3 * pixel + c] = static_cast<std::uint8_t>((sum[c] + votes / 2) / votes);
        }
    }
    return out;
}

OutlineError outline_error(const test::TruePicture& truth, const test::Photo& photo) {
    std::size_t num = 0;
    OutlineError error;
    for (std::size_t i = 0; i < truth.mask.data.size(); ++i) {
        const double opacity = photo.opacity.data[i] / 255.0;
        if (truth.mask.data[i] == 0) {
            error.beyond += opacity;
            continue;
        }
        ++num;
        error.bare += 1.0 - opacity;
    }
    error.bare /= static_cast<double>(num);
    error.beyond /= static_cast<double>(num);
    return error;
}

}  // namespace atrium::bench
