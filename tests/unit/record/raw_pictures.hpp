#pragma once

#include "core/config/rig.hpp"
#include "core/image/raw_image.hpp"
#include "site_node/capture/metaframe.hpp"
#include "tests/support/random.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

// Raw pictures and a rig for the tests of recordings.
namespace atrium::record::test {

/// A picture whose bytes compress: soft shades with a little noise. Rows have padding, as in the
/// buffers of drivers.
inline image::RawImage make_picture(image::PixelFormat format,
                                    int width,
                                    int height,
                                    std::uint64_t seed) {
    constexpr std::size_t kPadding = 5;
    atrium::test::Random random(seed);
    auto memory = std::make_shared<std::vector<std::uint8_t>>();
    image::RawImage picture;
    picture.format = format;
    picture.width = width;
    picture.height = height;
    std::vector<std::size_t> begins, strides;
    const auto add_plane = [&](std::size_t row, int num_rows) {
        begins.push_back(memory->size());
        strides.push_back(row + kPadding);
        for (int y = 0; y < num_rows; ++y) {
            for (std::size_t x = 0; x < row + kPadding; ++x) {
                const int shade = 60 + y + static_cast<int>(x) / 2 + static_cast<int>(seed % 32);
                memory->push_back(
                    static_cast<std::uint8_t>(shade + atrium::test::between(random, 0, 3)));
            }
        }
    };
    add_plane(image::row_bytes(format, width), height);
    if (format == image::PixelFormat::kYuv420) {
        add_plane(static_cast<std::size_t>(width) / 2, height / 2);
        add_plane(static_cast<std::size_t>(width) / 2, height / 2);
    }
    for (std::size_t i = 0; i < begins.size(); ++i)
        picture.planes[i] = {memory->data() + begins[i], strides[i]};
    picture.owner = std::move(memory);
    return picture;
}

/// All bytes of the pixels, without padding.
inline std::vector<std::uint8_t> bytes_of(const image::RawImage& picture) {
    std::vector<std::uint8_t> bytes;
    const auto add = [&](const image::RawImage::RawPlane& plane, std::size_t row, int num_rows) {
        for (int y = 0; y < num_rows; ++y) {
            const std::uint8_t* const begin =
                plane.data + static_cast<std::size_t>(y) * plane.stride_bytes;
            bytes.insert(bytes.end(), begin, begin + row);
        }
    };
    add(picture.planes[0], image::row_bytes(picture.format, picture.width), picture.height);
    if (picture.format == image::PixelFormat::kYuv420) {
        const auto half = static_cast<std::size_t>(picture.width) / 2;
        add(picture.planes[1], half, picture.height / 2);
        add(picture.planes[2], half, picture.height / 2);
    }
    return bytes;
}

inline const std::vector<image::PixelFormat>& all_formats() {
    using enum image::PixelFormat;
    static const std::vector<image::PixelFormat> all{
        kYuv420, kMono8, kBayerRG, kBayerGR, kBayerGB, kBayerBG, kRgb, kBgr, kUyvy, kYuyv};
    return all;
}

/// Cameras "cam0", "cam1", ... of this size. Their poses are not those of a room.
inline config::Rig make_rig(int num_cameras, int width, int height, double rate_hz = 30.0) {
    config::Rig rig;
    rig.rate_hz = rate_hz;
    for (int i = 0; i < num_cameras; ++i) {
        geometry::CalibratedCamera camera;
        camera.name = "cam" + std::to_string(i);
        camera.intrinsics.width = width;
        camera.intrinsics.height = height;
        camera.intrinsics.fx = camera.intrinsics.fy = 1.1 * width;
        camera.intrinsics.cx = 0.5 * (width - 1);
        camera.intrinsics.cy = 0.5 * (height - 1);
        camera.camera_from_site.translation = {0.1 * i, 0.0, 3.0};
        rig.cameras.push_back(camera);
    }
    return rig;
}

/// An empty folder that is removed at the end of the test.
class OwnFolder : public testing::Test {
protected:
    OwnFolder()
        : folder_(std::filesystem::path(testing::TempDir()) /
                  ("atrium_record_" + std::to_string(getpid()))) {
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    ~OwnFolder() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path folder_;
};

}  // namespace atrium::record::test
