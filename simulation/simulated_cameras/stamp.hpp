#pragma once

#include "core/image/raw_image.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace atrium::simulated_cameras {

/// What a picture says of itself, as ground truth: who took it at which trigger.
struct Stamp {
    std::uint8_t camera = 0;
    std::uint32_t trigger = 0;
    bool operator==(const Stamp&) const = default;
};

/// The stamp lies in the first `kStampWidthPx` columns of the first and again of the last
/// `kStampHeightPx` rows, so that a picture put together of two shows. It is 16 by 4 blocks of 8 by
/// 8 px, white for one and black for zero: a fixed byte, the camera, the trigger, a checksum, each
/// from the highest bit.
constexpr int kStampWidthPx = 128;
constexpr int kStampHeightPx = 32;

/// Writes it into packed pixels of `bytes_per_pixel` equal bytes each, rows without padding. Every
/// sample of a block has the same value, so any mosaic shows it. A picture that is narrower than a
/// stamp, or lower than two, gets none.
void write_stamp(
    const Stamp& stamp, std::size_t bytes_per_pixel, int width, int height, std::uint8_t* pixels);

/// Reads it from a picture of any format; nullopt where there is none, where part of it was lost,
/// or where the first rows and the last ones say different things.
std::optional<Stamp> read_stamp(const image::RawImage& picture);

}  // namespace atrium::simulated_cameras
