// Qualisys Track Manager's calibration XML (also named .qca.txt). Intrinsics are in 1/64 px of the
// sensor, whose first pixel spans 0 to 63; distortion is OpenCV's; a camera has its position [mm]
// and the rotation, row by row, into axes of OpenGL. Theia writes the same elements in pixels and
// with camera_from_site, which the judgement of the poses finds out.
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/lens.hpp"
#include "tools/calibrate/formats/xml_numbers.hpp"

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace atrium::calibrate {
namespace {

constexpr double kUnitsPerPixel = 64.0;

tl::unexpected<Error> wrong(const std::string& where,
                            const ForeignCamera& camera,
                            const std::string& what) {
    return make_error(ErrorKind::kInvalidData,
                      fmt::format("{}: camera '{}': {}", where, camera.name, what));
}

// The part of the sensor that the video shows [px]: left, top, width, height.
struct Window {
    double left = 0.0;
    double top = 0.0;
    double width = 0.0;
    double height = 0.0;
};

// Sensor units per pixel: 64 in files of Qualisys, 1 in those in pixels.
double units_per_pixel(const pugi::xml_node& intrinsic) {
    const double last = attribute_number(intrinsic, "sensorMaxU").value_or(0.0);
    return last < 10'000.0 && last > 0.0 ? 1.0 : kUnitsPerPixel;
}

// Size [px] of a sensor whose sensorMax are these, by which Qualisys means the last unit. Files in
// pixels may mean the size itself: pictures have even sizes, so their last pixel has an odd number.
Eigen::Vector2d sensor_size(const Eigen::Vector2d& sensor_max, double units) {
    const bool is_size = units == 1.0 && std::fmod(sensor_max.x(), 2.0) == 0.0 &&
                         std::fmod(sensor_max.y(), 2.0) == 0.0;
    return is_size ? sensor_max : Eigen::Vector2d((sensor_max + Eigen::Vector2d::Ones()) / units);
}

std::optional<Window> window_of(const pugi::xml_node& node, const pugi::xml_node& intrinsic) {
    const pugi::xml_node fov = node.child("fov_video");
    const auto left = attribute_number(fov, "left");
    const auto top = attribute_number(fov, "top");
    const auto right = attribute_number(fov, "right");
    const auto bottom = attribute_number(fov, "bottom");
    if (left && top && right && bottom)
        return Window{*left, *top, *right - *left + 1.0, *bottom - *top + 1.0};
    // without a window: the whole sensor
    const auto last_u = attribute_number(intrinsic, "sensorMaxU");
    const auto last_v = attribute_number(intrinsic, "sensorMaxV");
    if (!last_u || !last_v) return std::nullopt;
    const double units = units_per_pixel(intrinsic);
    const Eigen::Vector2d size = sensor_size({*last_u, *last_v}, units);
    return Window{0.0, 0.0, size.x(), size.y()};
}

// Most cameras of Qualisys see markers only. Some models take pictures without saying so.
bool is_marker_model(std::string_view model) {
    return !model.empty() && model != "none" && model.find("Video") == std::string_view::npos &&
           model.find("Hybrid") == std::string_view::npos;
}

Expected<void> read_intrinsic(const pugi::xml_node& node,
                              const std::string& where,
                              ForeignCamera& camera,
                              std::vector<std::string>& notes) {
    const pugi::xml_node intrinsic = node.child("intrinsic");
    LensNumbers lens;
    for (const char* name :
         {"focalLengthU", "skew", "centerPointU", "focalLengthV", "centerPointV"}) {
        const auto value = attribute_number(intrinsic, name);
        if (!value && std::string(name) != "skew")
            return wrong(where, camera, fmt::format("<intrinsic> lacks a number {}", name));
        lens.matrix.push_back(value.value_or(0.0));
    }
    for (const char* name : {"radialDistortion1",
                             "radialDistortion2",
                             "tangentalDistortion1",
                             "tangentalDistortion2",
                             "radialDistortion3"})
        lens.distortion.push_back(attribute_number(intrinsic, name).value_or(0.0));
    const auto window = window_of(node, intrinsic);
    if (!window) return wrong(where, camera, "neither <fov_video> nor sensorMaxU and sensorMaxV");
    const double units = units_per_pixel(intrinsic);
    constexpr const char* kInPixels =
        "intrinsics: in pixels, not in 1/64 px as Qualisys writes them (sensorMaxU is below 10000)";
    if (units == 1.0 && std::ranges::find(notes, kInPixels) == notes.end())
        notes.emplace_back(kInPixels);
    const std::vector<double> m = lens.matrix;
    // unit 0 is the first of a pixel's units, and the pixel's centre between them all
    const double centre = 0.5 * (units - 1.0);
    lens.matrix = {m[0] / units,
                   m[1] / units,
                   (m[2] - centre) / units - window->left,
                   0.0,
                   m[3] / units,
                   (m[4] - centre) / units - window->top,
                   0.0,
                   0.0,
                   1.0};
    lens.size = {window->width, window->height};
    return set_lens(camera, lens, where, notes);
}

// A typing error or a decimal comma; also of a camera for markers, which may have pictures.
Expected<void> check_readable_numbers(const pugi::xml_node& node, const std::string& where) {
    ForeignCamera camera;
    camera.name = node.attribute("serial").value();
    const std::array bad{
        unreadable_number(node.child("fov_video"), {"left", "top", "right", "bottom"}),
        unreadable_number(
            node.child("transform"),
            {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33", "x", "y", "z"}),
        unreadable_number(node.child("intrinsic"),
                          {"focalLengthU",
                           "skew",
                           "centerPointU",
                           "focalLengthV",
                           "centerPointV",
                           "radialDistortion1",
                           "radialDistortion2",
                           "radialDistortion3",
                           "tangentalDistortion1",
                           "tangentalDistortion2",
                           "sensorMaxU",
                           "sensorMaxV"})};
    for (const std::string& text : bad)
        if (!text.empty()) return wrong(where, camera, text);
    return {};
}

Expected<ForeignCamera> qualisys_camera(const pugi::xml_node& node,
                                        const std::string& where,
                                        std::vector<std::string>& notes) {
    ForeignCamera camera;
    camera.name = node.attribute("serial").value();
    camera.model = node.attribute("model").value();
    const double turn_deg = attribute_number(node, "viewrotation").value_or(0.0);
    camera.view_rotation_deg = turn_deg == 90.0 ? 90 : turn_deg == 270.0 ? 270 : 0;
    camera.is_for_markers = is_marker_model(camera.model);
    if (auto read = read_intrinsic(node, where, camera, notes); !read)
        return tl::unexpected(read.error());
    const pugi::xml_node transform = node.child("transform");
    std::vector<double> values;
    for (const char* name :
         {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33", "x", "y", "z"}) {
        const auto value = attribute_number(transform, name);
        if (!value) return wrong(where, camera, fmt::format("<transform> lacks a number {}", name));
        values.push_back(*value);
    }
    const auto rotation = rotation_of({values.begin(), values.begin() + 9});
    if (!rotation)
        return wrong(
            where, camera, "r11 to r33 are no right-handed rotation; calibrate in QTM again");
    camera.pose = ForeignPose{*rotation, {values[9], values[10], values[11]}};
    return camera;
}

// QTM keeps the last pose of such a camera, or zeros.
bool is_uncalibrated(const pugi::xml_node& node) {
    return std::string_view(node.attribute("calibrated").value()) == "false";
}

// Adds a camera, or why it is left out.
Expected<void> add_camera(const pugi::xml_node& node, const std::string& where, ForeignRig& rig) {
    const std::string name = node.attribute("serial").value();
    const std::string cure = "calibrate it in QTM";
    if (std::string_view(node.attribute("active").value()) == "0") {
        rig.left_out[name] = "it is not active in QTM's file: make it active, and " + cure;
        return {};
    }
    const bool is_for_markers = is_marker_model(node.attribute("model").value());
    if (is_uncalibrated(node)) {
        rig.left_out[name] = is_for_markers ? "QTM did not calibrate it: " + cure : "";
        if (is_for_markers) return {};
        rig.problems.push_back(
            fmt::format("camera '{}' is not calibrated (QTM says so): left out; calibrate it in "
                        "QTM, or go on without it: a hull from fewer cameras is thicker",
                        name));
        return {};
    }
    if (auto readable = check_readable_numbers(node, where); !readable) return readable;
    auto camera = qualisys_camera(node, where, rig.notes);
    if (!camera && !is_for_markers) return tl::unexpected(camera.error());
    if (camera) {
        // by 90 or 270 degrees, the pictures' size tells
        if (!is_for_markers && attribute_number(node, "viewrotation").value_or(0.0) == 180.0)
            rig.checks.push_back(
                fmt::format("camera '{}': QTM may have exported its video upside down, as "
                            "viewrotation 180 says; look at it: if it is, export it with a "
                            "rotation of 0, or turn it back: ffmpeg -i FILE -vf hflip,vflip OUT",
                            name));
        rig.cameras.push_back(std::move(*camera));
    } else {
        rig.left_out[name] = camera.error().message + ": " + cure;
    }
    return {};
}

}  // namespace

Expected<ForeignRig> read_qualisys(const Files& files) {
    ForeignRig rig;
    rig.format = "Qualisys";
    rig.documented = {Reading::Pose::kRotationAndPosition, true};
    rig.units = "mm";
    rig.up = "+Z";
    for (const auto& file : files) {
        pugi::xml_document document;
        if (auto loaded = load_xml(file, document); !loaded) return tl::unexpected(loaded.error());
        for (const pugi::xml_node node :
             document.child("calibration").child("cameras").children("camera")) {
            if (auto added = add_camera(node, file.string(), rig); !added)
                return tl::unexpected(added.error());
        }
    }
    std::vector<std::string> left_out;
    for (const auto& [name, reason] : rig.left_out)
        if (!reason.empty()) left_out.push_back(name);
    if (!left_out.empty()) {
        rig.notes.push_back(fmt::format(
            "cameras that are not active, or for markers without a calibration, were left out: {}",
            fmt::join(left_out, ", ")));
    }
    return rig;
}

}  // namespace atrium::calibrate
