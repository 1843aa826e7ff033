#pragma once

#include "core/image/image.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::segmentation {

/// Memory for doubt_of_light.
struct LightScratch {
    std::vector<double> room;  // per place [grey levels]
    std::vector<double> picture;
    std::vector<double> ratios;
    std::vector<double> differences;
    std::vector<double> sorted;
};

/// Compares a picture with the empty room, at places spread over both. Says why people cannot be
/// told from this room: most places differ in brightness by more than shadows, highlights and the
/// compensation of the light explain ("is 4.1 times darker than the pictures"), the room is "one
/// plain grey (128 of 255)", or squares with texture show something else ("shows another view:
/// ..."). nullopt if they fit, or for a room of another size than the picture.
///
/// `room_luma`: means per pixel [1/256], row by row, as in BackgroundStatistics. Somebody right in
/// front of the camera also hides most places: ask several pictures. Allocates only while `scratch`
/// grows, or for a doubt.
std::optional<std::string> doubt_of_light(std::span<const std::uint16_t> room_luma,
                                          const image::PlaneView& picture_luma,
                                          LightScratch& scratch);

}  // namespace atrium::segmentation
