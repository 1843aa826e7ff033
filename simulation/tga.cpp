#include "simulation/tga.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace atrium::simulation {
namespace {

constexpr std::size_t kHeaderBytes = 18;
constexpr int kMaxTgaSidePx = 16384;

// Fields of the header, Truevision TGA File Format Specification 2.0.
struct TgaHeader {
    bool is_grey = false;
    bool is_run_length = false;
    int width = 0;
    int height = 0;
    std::size_t bytes_per_pixel = 0;
    bool is_top_first = false;
    std::size_t first_pixel = 0;
};

std::optional<TgaHeader> read_header(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < kHeaderBytes) return std::nullopt;
    const int type = bytes[2];
    if (bytes[1] != 0 || (type != 2 && type != 3 && type != 10 && type != 11)) return std::nullopt;
    TgaHeader header;
    header.is_grey = type == 3 || type == 11;
    header.is_run_length = type >= 10;
    header.width = bytes[12] | bytes[13] << 8;
    header.height = bytes[14] | bytes[15] << 8;
    header.bytes_per_pixel = bytes[16] / 8U;
    header.is_top_first = (bytes[17] & 0x20U) != 0;
    header.first_pixel = kHeaderBytes + bytes[0];
    const bool has_known_pixels =
        header.is_grey ? bytes[16] == 8 : bytes[16] == 24 || bytes[16] == 32;
    const bool has_known_size = header.width > 0 && header.height > 0 &&
                                header.width <= kMaxTgaSidePx && header.height <= kMaxTgaSidePx;
    if (!has_known_pixels || !has_known_size || header.first_pixel > bytes.size())
        return std::nullopt;
    return header;
}

std::array<std::uint8_t, 4> pixel(const TgaHeader& header, const std::uint8_t* bytes) {
    if (header.is_grey) return {bytes[0], bytes[0], bytes[0], 255};
    return {bytes[0],
            bytes[1],
            bytes[2],
            header.bytes_per_pixel == 4 ? bytes[3] : static_cast<std::uint8_t>(255)};
}

}  // namespace

std::optional<TgaPicture> read_tga(std::span<const std::uint8_t> bytes) {
    const auto header = read_header(bytes);
    if (!header) return std::nullopt;
    const std::size_t num_pixels =
        static_cast<std::size_t>(header->width) * static_cast<std::size_t>(header->height);
    std::vector<std::uint8_t> pixels;  // in the order of the file
    std::size_t at = header->first_pixel;
    while (pixels.size() < 4 * num_pixels) {
        std::size_t num_same = 1;
        std::size_t num_plain = num_pixels;
        if (header->is_run_length) {
            if (at >= bytes.size()) return std::nullopt;
            const std::size_t length = (bytes[at] & 0x7fU) + 1U;
            const bool is_run = (bytes[at++] & 0x80U) != 0;
            num_same = is_run ? length : 1;
            num_plain = is_run ? 1 : length;
        }
        if (num_plain * header->bytes_per_pixel > bytes.size() - at) return std::nullopt;
        for (std::size_t i = 0; i < num_plain && pixels.size() < 4 * num_pixels; ++i) {
            const auto value = pixel(*header, &bytes[at]);
            for (std::size_t k = 0; k < num_same && pixels.size() < 4 * num_pixels; ++k)
                pixels.insert(pixels.end(), value.begin(), value.end());
            at += header->bytes_per_pixel;
        }
    }
    TgaPicture picture{header->width, header->height, std::move(pixels)};
    if (header->is_top_first) return picture;
    const auto row = 4 * static_cast<std::ptrdiff_t>(header->width);
    for (int y = 0; y < header->height / 2; ++y) {
        const auto upper = picture.bgra.begin() + y * row;
        std::swap_ranges(upper, upper + row, picture.bgra.begin() + (header->height - 1 - y) * row);
    }
    return picture;
}

}  // namespace atrium::simulation
