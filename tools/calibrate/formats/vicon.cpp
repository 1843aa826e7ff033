// Vicon's .xcp. A camera has one KeyFrame with its orientation (quaternion, real part last),
// position [mm], focal length and principal point [px]. VICON_RADIAL2 holds a name, the centre and
// two or three coefficients. Below 1e-4 they are of pixels, and straighten; above, of the
// normalised plane, as OpenCV's.
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/lens.hpp"
#include "tools/calibrate/formats/lens_fit.hpp"
#include "tools/calibrate/formats/xml_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace atrium::calibrate {
namespace {

constexpr double kSmallerIsOfPixels = 1e-4;

// The radial coefficients, up to three.
std::vector<double> radial_of(const pugi::xml_node& frame) {
    const std::string named = frame.attribute("VICON_RADIAL2").value();
    std::istringstream words(named.empty() ? frame.attribute("VICON_RADIAL").value() : named);
    std::vector<double> values;
    for (std::string word; words >> word && values.size() < 8;) {
        char* end = nullptr;
        const double value = std::strtod(word.c_str(), &end);
        if (end != word.c_str() && *end == '\0' && std::isfinite(value)) values.push_back(value);
    }
    const std::size_t first = named.empty() ? 0 : 2;
    if (values.size() <= first) return {};
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
    values.resize(std::min<std::size_t>(values.size(), 3));
    return values;
}

Expected<void> set_radial(ForeignCamera& camera,
                          const std::vector<double>& radial,
                          const std::string& where,
                          std::vector<std::string>& notes) {
    geometry::PinholeCamera& k = camera.lens;
    const bool is_of_pixels =
        std::ranges::all_of(radial, [](double c) { return std::abs(c) < kSmallerIsOfPixels; });
    if (!is_of_pixels) {
        k.distortion = {radial[0],
                        radial.size() > 1 ? radial[1] : 0.0,
                        0.0,
                        0.0,
                        radial.size() > 2 ? radial[2] : 0.0};
        return {};
    }
    if (std::ranges::all_of(radial, [](double c) { return c == 0.0; })) return {};
    const double aspect = k.fx / k.fy;
    const LensFit fit = fit_lens_inverse(k, [&](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
        const Eigen::Vector2d off(pixel.x() - k.cx, (pixel.y() - k.cy) * aspect);
        const double r2 = off.squaredNorm();
        double scale = 1.0;
        double power = r2;
        for (const double c : radial) {
            scale += c * power;
            power *= r2;
        }
        return off * scale / k.fx;
    });
    return accept_fit(camera, fit.distortion, fit.error_px, "Vicon radial", where, notes);
}

Expected<ForeignCamera> vicon_camera(const pugi::xml_node& node,
                                     const pugi::xml_node& frame,
                                     const std::string& where,
                                     std::vector<std::string>& notes) {
    ForeignCamera camera;
    camera.name = node.attribute("DEVICEID").value();
    const auto wrong = [&](const std::string& what) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: camera '{}': {}", where, camera.name, what));
    };
    const std::array bad{
        unreadable_number(node, {"SENSOR_SIZE", "PIXEL_ASPECT_RATIO", "SKEW"}),
        unreadable_number(frame, {"FOCAL_LENGTH", "PRINCIPAL_POINT", "ORIENTATION", "POSITION"})};
    for (const std::string& text : bad)
        if (!text.empty()) return wrong(text);
    const auto size = attribute_numbers(node, "SENSOR_SIZE", 2);
    const auto focal = attribute_number(frame, "FOCAL_LENGTH");
    const auto centre = attribute_numbers(frame, "PRINCIPAL_POINT", 2);
    const auto quaternion = attribute_numbers(frame, "ORIENTATION", 4);
    const auto position = attribute_numbers(frame, "POSITION", 3);
    if (!size || !focal || !centre || !quaternion || !position) {
        return wrong(
            "SENSOR_SIZE, FOCAL_LENGTH, PRINCIPAL_POINT, ORIENTATION and POSITION must be "
            "finite numbers; calibrate the camera in Vicon's program");
    }
    const double aspect = attribute_number(node, "PIXEL_ASPECT_RATIO").value_or(1.0);
    if (!(aspect > 0.1 && aspect < 10.0)) return wrong("PIXEL_ASPECT_RATIO must be near 1");
    LensNumbers lens;
    const double skew = attribute_number(node, "SKEW").value_or(0.0);
    lens.matrix = {*focal, skew, (*centre)[0], 0, *focal / aspect, (*centre)[1], 0, 0, 1};
    lens.size = *size;
    if (auto set = set_lens(camera, lens, where, notes); !set) return tl::unexpected(set.error());
    if (const auto radial = radial_of(frame); !radial.empty()) {
        if (auto set = set_radial(camera, radial, where, notes); !set)
            return tl::unexpected(set.error());
    }
    const Eigen::Quaterniond rotation(
        (*quaternion)[3], (*quaternion)[0], (*quaternion)[1], (*quaternion)[2]);
    if (std::abs(rotation.norm() - 1.0) > 1e-2) return wrong("ORIENTATION is no unit quaternion");
    camera.pose = foreign_pose({rotation.normalized().conjugate(),
                                -(rotation.normalized().conjugate() *
                                  Eigen::Vector3d((*position)[0], (*position)[1], (*position)[2]))},
                               {Reading::Pose::kSiteFromCamera, false});
    return camera;
}

}  // namespace

Expected<ForeignRig> read_vicon(const Files& files) {
    ForeignRig rig;
    rig.format = "Vicon";
    rig.documented = {Reading::Pose::kSiteFromCamera, false};
    rig.units = "mm";
    rig.up = "+Z";
    std::size_t num_markers = 0;
    for (const auto& file : files) {
        pugi::xml_document document;
        if (auto loaded = load_xml(file, document); !loaded) return tl::unexpected(loaded.error());
        std::size_t num_video = 0;
        for (const bool wants_video : {true, false}) {
            // files of marker cameras alone are taken as they are, for their pictures may exist
            if (!wants_video && num_video > 0) break;
            for (const pugi::xml_node node : document.child("Cameras").children("Camera")) {
                const std::string type = node.attribute("TYPE").value() +
                                         std::string(node.attribute("DISPLAY_TYPE").value());
                const bool is_video = type.find("Video") != std::string::npos ||
                                      type.find("Vue") != std::string::npos;
                const pugi::xml_node frame = node.child("KeyFrames").child("KeyFrame");
                if (is_video && !frame) {
                    rig.left_out[node.attribute("DEVICEID").value()] =
                        "the file has no calibration of it (KeyFrame): calibrate it in Vicon's "
                        "program";
                }
                if (is_video != wants_video || !frame) continue;
                auto camera = vicon_camera(node, frame, file.string(), rig.notes);
                if (!camera) return tl::unexpected(camera.error());
                rig.cameras.push_back(std::move(*camera));
                num_video += wants_video ? 1 : 0;
            }
        }
        const auto all = document.child("Cameras").children("Camera");
        num_markers +=
            static_cast<std::size_t>(std::distance(all.begin(), all.end())) - rig.cameras.size();
    }
    if (num_markers > 0 && !rig.cameras.empty()) {
        rig.notes.push_back(fmt::format(
            "{} cameras for markers, or without a calibration, were left out", num_markers));
    }
    return rig;
}

}  // namespace atrium::calibrate
