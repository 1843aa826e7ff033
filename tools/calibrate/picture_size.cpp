#include "tools/calibrate/picture_size.hpp"

#include "tools/calibrate/recording/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace atrium::calibrate {
namespace {

constexpr double kRounding_px = 2.0;  // programs round to even sizes
constexpr double kNearZero = 0.15;    // of a picture's side

std::array<int, 2> size_of(const geometry::PinholeCamera& lens) {
    return {lens.width, lens.height};
}

}  // namespace

void read_point_offsets(ForeignRig& rig) {
    const auto is_offset = [](const ForeignCamera& camera) {
        const geometry::PinholeCamera& k = camera.lens;
        return camera.has_lens && k.width > 0 && k.height > 0 &&
               std::abs(k.cx) < kNearZero * k.width && std::abs(k.cy) < kNearZero * k.height;
    };
    if (rig.cameras.empty() || !std::ranges::all_of(rig.cameras, is_offset)) return;
    for (ForeignCamera& camera : rig.cameras) {
        camera.lens.cx += 0.5 * (camera.lens.width - 1);
        camera.lens.cy += 0.5 * (camera.lens.height - 1);
    }
    rig.checks.push_back(
        "lens: the principal points lie near 0, so they are read as offsets from the middle of the "
        "picture, as Meshroom, Metashape and RealityCapture write them");
}

double shape_difference(const std::array<int, 2>& a, const std::array<int, 2>& b) {
    if (std::min({a[0], a[1], b[0], b[1]}) <= 0) return 0.0;
    const auto& [small, large] = std::minmax(a, b);
    const double shape = static_cast<double>(large[0]) / large[1];
    const bool is_rounded = std::abs(small[1] * shape - small[0]) <= kRounding_px ||
                            std::abs(small[0] / shape - small[1]) <= kRounding_px;
    return is_rounded ? 0.0 : std::abs(small[1] * shape / small[0] - 1.0);
}

std::string cure_of_crop(const std::string& format, const std::array<int, 2>& size) {
    if (format == "Qualisys") {
        return fmt::format(
            "calibrate again with this crop, or write the part of the sensor that was filmed into "
            "fov_video of each camera: left, top, right = left + {}, bottom = top + {}",
            size[0] - 1,
            size[1] - 1);
    }
    return fmt::format(
        "calibrate again with this crop, or subtract what was cropped at the left from cx, at the "
        "top from cy, and write {}x{} px as the size of the calibration",
        size[0],
        size[1]);
}

std::string doubt_of_shapes(const ForeignRig& before, const ForeignRig& after) {
    std::vector<std::string> names;
    std::string text;
    for (const ForeignCamera& camera : after.cameras) {
        const auto old = std::ranges::find(before.cameras, camera.name, &ForeignCamera::name);
        if (old == before.cameras.end()) continue;
        const double difference = shape_difference(size_of(old->lens), size_of(camera.lens));
        if (difference == 0.0) continue;
        names.push_back(camera.known_name());
        if (!text.empty()) continue;
        text = fmt::format(
            "calibrated at {}x{} px, pictures of {}x{} px: these shapes differ by {:.2g} %: are "
            "the pictures cropped rather than scaled? If so, people will be missing or broken: "
            "leave --size and --calibrated-size out, and {}",
            old->lens.width,
            old->lens.height,
            camera.lens.width,
            camera.lens.height,
            100.0 * difference,
            cure_of_crop(after.format, size_of(camera.lens)));
    }
    return names.empty() ? std::string() : fmt::format("size: {}: {}", listed(names), text);
}

Expected<void> set_picture_size(ForeignCamera& camera, const std::array<int, 2>& size) {
    geometry::PinholeCamera& k = camera.lens;
    const double scale_x = k.width > 0 ? static_cast<double>(size[0]) / k.width : 1.0;
    const double scale_y = k.height > 0 ? static_cast<double>(size[1]) / k.height : 1.0;
    if (std::abs(scale_x / scale_y - 1.0) > kMostDifference) {
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
                            : "they were cropped; export whole pictures, or calibrate "
                              "again with this crop"));
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
