#pragma once

#include "core/image/raw_image.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace atrium::simulated_cameras {

/// Ground truth inside a picture: its camera and trigger.
struct Stamp {
    std::uint8_t camera = 0;
    std::uint32_t trigger = 0;
    bool operator==(const Stamp&) const = default;
};

/// The stamp occupies the first `kStampWidthPx` columns of the first and of the last
/// `kStampHeightPx` rows: a picture assembled from two is detected. It has 16 by 4 blocks of 8 by 8
/// px, white for one and black for zero: a fixed byte, the camera, the trigger, a checksum, each
/// from the highest bit.
constexpr int kStampWidthPx = 128;
constexpr int kStampHeightPx = 32;

/// Writes a stamp into packed pixels of `bytes_per_pixel` equal bytes each, rows without padding.
/// All samples of a block are equal, which suits any mosaic. Pictures narrower than a stamp, or
/// lower than two stamps, stay unchanged.
void write_stamp(
    const Stamp& stamp, std::size_t bytes_per_pixel, int width, int height, std::uint8_t* pixels);

/// Reads the stamp of a picture of any format. nullopt if it has none, part of it is lost, or its
/// first and last rows disagree.
std::optional<Stamp> read_stamp(const image::RawImage& picture);

}  // namespace atrium::simulated_cameras
