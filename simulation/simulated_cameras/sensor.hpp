#pragma once

#include "core/base/expected.hpp"
#include "core/image/raw_image.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::simulated_cameras {

/// The pixel formats that a simulated camera can have, by their GenICam names: BayerRG8, BayerGR8,
/// BayerGB8, BayerBG8, Mono8, RGB8. Error kConfiguration for others.
Expected<image::PixelFormat> find_pixel_format(std::string_view genicam_name);
std::vector<std::string> pixel_format_names();

/// Bytes of a picture as a sensor of that format would deliver it: packed rows without padding. A
/// mosaic has of every pixel the one colour of its filter. `format` is one of the above.
std::vector<std::uint8_t> sense(const image::YuvView& picture, image::PixelFormat format);

}  // namespace atrium::simulated_cameras
