#include "tools/simulated_cameras/stamp.hpp"

#include <array>
#include <cstring>
#include <span>

namespace atrium::simulated_cameras {
namespace {

constexpr int kBlockPx = 8;
constexpr int kBlocksPerRow = kStampWidthPx / kBlockPx;
constexpr std::size_t kNumBytes = 8;
static_assert(kBlocksPerRow * (kStampHeightPx / kBlockPx) == 8 * kNumBytes);

// Far enough from both ends for noise, and apart enough for any threshold between them.
constexpr std::uint8_t kBlack = 16;
constexpr std::uint8_t kWhite = 235;
constexpr std::uint8_t kFirstByte = 0xa6;  // not black, white or striped

using Code = std::array<std::uint8_t, kNumBytes>;

// CRC-16 with the polynomial of CCITT.
std::uint16_t checksum(std::span<const std::uint8_t> bytes) {
    unsigned sum = 0xffff;
    for (const std::uint8_t byte : bytes) {
        sum ^= static_cast<unsigned>(byte) << 8;
        for (int bit = 0; bit < 8; ++bit)
            sum = (sum & 0x8000u) != 0 ? (sum << 1) ^ 0x1021u : sum << 1;
    }
    return static_cast<std::uint16_t>(sum);
}

Code encode(const Stamp& stamp) {
    Code code{kFirstByte,
              stamp.camera,
              static_cast<std::uint8_t>(stamp.trigger >> 24),
              static_cast<std::uint8_t>(stamp.trigger >> 16),
              static_cast<std::uint8_t>(stamp.trigger >> 8),
              static_cast<std::uint8_t>(stamp.trigger)};
    const std::uint16_t sum = checksum(std::span(code).first(kNumBytes - 2));
    code[kNumBytes - 2] = static_cast<std::uint8_t>(sum >> 8);
    code[kNumBytes - 1] = static_cast<std::uint8_t>(sum);
    return code;
}

// Position of the brightness samples of a picture.
struct Samples {
    std::size_t first = 0;
    std::size_t step = 1;  // [B]
};

Samples samples_of(image::PixelFormat format) {
    switch (format) {
        case image::PixelFormat::kRgb:
        case image::PixelFormat::kBgr:
            return {1, 3};
        case image::PixelFormat::kUyvy:
            return {1, 2};
        case image::PixelFormat::kYuyv:
            return {0, 2};
        default:
            return {0, 1};
    }
}

// `pixels` points to the first row of the stamp.
void write_code(const Code& code,
                std::size_t bytes_per_pixel,
                std::size_t stride_bytes,
                std::uint8_t* pixels) {
    for (int block = 0; block < static_cast<int>(8 * kNumBytes); ++block) {
        const bool is_set =
            ((code[static_cast<std::size_t>(block / 8)] >> (7 - block % 8)) & 1) != 0;
        const auto left = static_cast<std::size_t>(block % kBlocksPerRow * kBlockPx);
        const auto top = static_cast<std::size_t>(block / kBlocksPerRow * kBlockPx);
        for (std::size_t y = top; y < top + kBlockPx; ++y) {
            std::memset(pixels + y * stride_bytes + left * bytes_per_pixel,
                        is_set ? kWhite : kBlack,
                        kBlockPx * bytes_per_pixel);
        }
    }
}

Code read_code(const image::RawImage& picture, int first_row) {
    const auto [first, step] = samples_of(picture.format);
    Code code{};
    for (int block = 0; block < static_cast<int>(8 * kNumBytes); ++block) {
        // the inner quarter of the block: a lens or codec may have changed its rim
        const int left = block % kBlocksPerRow * kBlockPx + kBlockPx / 4;
        const int top = first_row + block / kBlocksPerRow * kBlockPx + kBlockPx / 4;
        int sum = 0;
        for (int y = top; y < top + kBlockPx / 2; ++y) {
            const std::uint8_t* row = picture.planes[0].data +
                                      static_cast<std::size_t>(y) * picture.planes[0].stride_bytes;
            for (int x = left; x < left + kBlockPx / 2; ++x)
                sum += row[first + static_cast<std::size_t>(x) * step];
        }
        const bool is_set = sum > 128 * (kBlockPx / 2) * (kBlockPx / 2);
        auto& byte = code[static_cast<std::size_t>(block / 8)];
        byte = static_cast<std::uint8_t>(byte << 1 | (is_set ? 1 : 0));
    }
    return code;
}

bool has_room(int width, int height) {
    return width >= kStampWidthPx && height >= 2 * kStampHeightPx;
}

}  // namespace

void write_stamp(
    const Stamp& stamp, std::size_t bytes_per_pixel, int width, int height, std::uint8_t* pixels) {
    if (!has_room(width, height)) return;
    const Code code = encode(stamp);
    const std::size_t stride_bytes = static_cast<std::size_t>(width) * bytes_per_pixel;
    const auto last = static_cast<std::size_t>(height - kStampHeightPx) * stride_bytes;
    write_code(code, bytes_per_pixel, stride_bytes, pixels);
    write_code(code, bytes_per_pixel, stride_bytes, pixels + last);
}

std::optional<Stamp> read_stamp(const image::RawImage& picture) {
    if (picture.empty() || !has_room(picture.width, picture.height)) return std::nullopt;
    const Code code = read_code(picture, 0);
    const Stamp stamp{code[1],
                      static_cast<std::uint32_t>(code[2]) << 24 |
                          static_cast<std::uint32_t>(code[3]) << 16 |
                          static_cast<std::uint32_t>(code[4]) << 8 | code[5]};
    if (code != encode(stamp) || code != read_code(picture, picture.height - kStampHeightPx))
        return std::nullopt;
    return stamp;
}

}  // namespace atrium::simulated_cameras
