#include "tools/simulated_cameras/grey_notice.hpp"

#include <fmt/format.h>

namespace atrium::simulated_cameras {

std::optional<std::string> GreyNotice::look(const std::string& camera,
                                            const PictureRequest& asked,
                                            const PictureRequest& sensor) {
    if (asked == last_) return std::nullopt;
    last_ = asked;
    const bool has_region = asked.x + asked.width <= sensor.width &&
                            asked.y + asked.height <= sensor.height && asked.x >= 0 && asked.y >= 0;
    return fmt::format(
        "camera {} sends grey: asked for {}x{}+{}+{} {}, it has {}x{} {}; {}",
        camera,
        asked.width,
        asked.height,
        asked.x,
        asked.y,
        asked.format,
        sensor.width,
        sensor.height,
        sensor.format,
        has_region ? "serve with --pixel_format " + asked.format + ", or ask for " + sensor.format
                   : "probably the client's rig (capture.rig of a site) is not that "
                     "of these cameras (--rig)");
}

}  // namespace atrium::simulated_cameras
