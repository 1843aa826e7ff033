#pragma once

#include "core/base/expected.hpp"
#include "core/image/raw_image.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::simulated_cameras {

/// Finds a pixel format of the simulated cameras by its GenICam name: BayerRG8, BayerGR8, BayerGB8,
/// BayerBG8, Mono8, RGB8. Error kConfiguration for others.
Expected<image::PixelFormat> find_pixel_format(std::string_view genicam_name);
std::vector<std::string> pixel_format_names();

/// Converts a picture to the bytes that a sensor of this format delivers: packed rows without
/// padding. A mosaic has one colour per pixel, that of its filter. `format` must be one of the
/// above.
std::vector<std::uint8_t> sense(const image::YuvView& picture, image::PixelFormat format);

}  // namespace atrium::simulated_cameras
