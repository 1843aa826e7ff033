#include "tools/calibrate/conclude.hpp"

#include <fmt/format.h>

#include <cmath>

namespace atrium::calibrate {

Expected<void> set_picture_size(ForeignCamera& camera, const std::array<int, 2>& size) {
    geometry::PinholeCamera& k = camera.lens;
    const double scale_x = k.width > 0 ? static_cast<double>(size[0]) / k.width : 1.0;
    const double scale_y = k.height > 0 ? static_cast<double>(size[1]) / k.height : 1.0;
    if (std::abs(scale_x / scale_y - 1.0) > 0.01) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("camera '{}': calibrated at {}x{} px, but its pictures have {}x{} px, "
                        "which is another "
                        "shape: {}",
                        camera.name,
                        k.width,
                        k.height,
                        size[0],
                        size[1],
                        std::abs(k.width * size[0] - k.height * size[1]) < 0.02 * k.width * size[0]
                            ? "they were turned; export them as the camera took them"
                            : "they were cropped; export whole pictures"));
    }
    k.fx *= scale_x;
    k.fy *= scale_y;
    k.skew *= scale_x;
    k.cx = (k.cx + 0.5) * scale_x - 0.5;  // the border of the picture is at -0.5
    k.cy = (k.cy + 0.5) * scale_y - 0.5;
    k.width = size[0];
    k.height = size[1];
    return {};
}

}  // namespace atrium::calibrate
