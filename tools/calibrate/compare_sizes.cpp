#include "tools/calibrate/compare_sizes.hpp"

#include "tools/calibrate/picture_size.hpp"
#include "tools/calibrate/recording/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace atrium::calibrate {
namespace {

// Whether pictures have the shape of the calibration, but on its side.
bool is_on_its_side(const geometry::PinholeCamera& lens, const Look& look) {
    const double calibrated = static_cast<double>(lens.width) / lens.height;
    const double seen = static_cast<double>(look.width) / look.height;
    return std::abs(calibrated * seen - 1.0) < 0.02 && std::abs(calibrated / seen - 1.0) > 0.02;
}

// A command for videos, which honours the file's tag first.
std::string turning(const std::string& file, int transpose) {
    const std::size_t dot = file.find_last_of("./");
    const std::string suffix =
        dot == std::string::npos || file[dot] == '/' ? std::string() : file.substr(dot);
    return fmt::format("`ffmpeg -i {} -vf transpose={} OUT{}`", quoted(file), transpose, suffix);
}

// The cure for pictures on their side. No file says in which direction QTM turns, so both are
// given: transpose=2 undoes a turn by 90 degrees clockwise.
std::string turn_back(const ForeignCamera& camera, const Shots& shots, int tag_deg) {
    const int qtm_deg = camera.view_rotation_deg;
    if (qtm_deg == 90 || qtm_deg == 270) {
        return fmt::format(
            "QTM turned them, as viewrotation {} of the calibration says; export them with a "
            "rotation of 0, or turn them back: ffmpeg -i FILE -vf transpose={} OUT; if the "
            "silhouettes do not fit then, with transpose={}",
            qtm_deg,
            qtm_deg == 90 ? 2 : 1,
            qtm_deg == 90 ? 1 : 2);
    }
    const std::string file = shots.path.string();
    if (!shots.is_video)
        return "they were turned, perhaps as their EXIF data say; export them as the camera took "
               "them";
    if (tag_deg == 90 || tag_deg == 270) {
        return fmt::format(
            "{} has a rotation tag of {} degrees, by which its pictures were turned; the "
            "calibration is of pictures without it: turn it back with {}",
            file,
            tag_deg,
            turning(file, tag_deg == 90 ? 2 : 1));
    }
    return fmt::format(
        "{} has no rotation tag: turn it with {}, or transpose=2 if it is then upside down",
        file,
        turning(file, 1));
}

// The camera of a picture on its side, and the others.
tl::unexpected<Error> turned(const std::vector<const ForeignCamera*>& cameras,
                             const Material& material) {
    const ForeignCamera& camera = *cameras.front();
    const Look& look = material.looks.at(camera.name);
    std::vector<std::string> others;
    for (std::size_t i = 1; i < cameras.size(); ++i) others.push_back(cameras[i]->known_name());
    return make_error(
        ErrorKind::kConfiguration,
        fmt::format("camera '{}': calibrated at {}x{} px, but its pictures have {}x{} px: {}{}",
                    camera.known_name(),
                    camera.lens.width,
                    camera.lens.height,
                    look.width,
                    look.height,
                    turn_back(camera, material.frames.at(camera.name), look.rotation_deg),
                    others.empty() ? "" : "; the same with " + listed(others)));
}

// Of the undistorted pictures that COLMAP makes, each camera's has a size of its own.
std::string doubt_of_undistorted(const ForeignRig& rig) {
    const bool has_distortion = std::ranges::any_of(rig.cameras, [](const ForeignCamera& camera) {
        return std::ranges::any_of(camera.lens.distortion, [](double k) { return k != 0.0; });
    });
    if (rig.format != "COLMAP" || has_distortion) return {};
    return "the lenses of this model have no distortion: if it is of the pictures that `colmap "
           "image_undistorter` made (dense/), give the model of those that the cameras took "
           "(sparse/0), or the undistorted ones as --recording";
}

// Scaled pictures have the shape of the calibration, and --size refuses much of another one.
Error another_size(const ForeignCamera& camera,
                   const Look& look,
                   const std::string& format,
                   const std::string& undistorted) {
    const std::array size{look.width, look.height};
    const double difference = shape_difference({camera.lens.width, camera.lens.height}, size);
    const std::string scaled = fmt::format(
        "if they show the whole picture, scaled, say --size {}x{}", look.width, look.height);
    const std::string cropped = cure_of_crop(format, size);
    return {ErrorKind::kConfiguration,
            fmt::format("camera '{}': calibrated at {}x{} px, but its pictures have {}x{} px; {}{}",
                        camera.known_name(),
                        camera.lens.width,
                        camera.lens.height,
                        look.width,
                        look.height,
                        undistorted.empty() ? "" : undistorted + "; otherwise ",
                        difference == 0.0
                            ? fmt::format("{}; if they were cropped, {}", scaled, cropped)
                            : fmt::format("their shapes differ by {:.2g} %, so they look cropped: "
                                          "{}{}",
                                          100.0 * difference,
                                          cropped,
                                          difference < kMostDifference ? "; " + scaled : ""))};
}

Expected<void> compare(ForeignCamera& camera,
                       const Look& look,
                       const Said& said,
                       const std::string& format,
                       const std::string& undistorted) {
    const bool is_unknown = camera.lens.width == 0 || camera.lens.height == 0;
    if (camera.lens.width == look.width && camera.lens.height == look.height) return {};
    if (!is_unknown && !said.size && !said.calibrated_size)
        return tl::unexpected(another_size(camera, look, format, undistorted));
    if (said.size && *said.size != std::array{look.width, look.height}) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("--size says {0}x{1}, but the pictures of camera '{2}' have {3}x{4} px; if "
                        "the cameras were calibrated at {0}x{1} px, say --calibrated-size {0}x{1} "
                        "instead",
                        (*said.size)[0],
                        (*said.size)[1],
                        camera.known_name(),
                        look.width,
                        look.height));
    }
    auto scaled = set_picture_size(camera, {look.width, look.height});
    if (!scaled && !undistorted.empty()) scaled.error().message += "; " + undistorted;
    return scaled;
}

// Scaled pictures hide that a model is of undistorted ones.
void check_undistorted(ForeignRig& rig, const ForeignRig& before, const std::string& undistorted) {
    const auto size_of = [](const ForeignCamera& camera) {
        return std::array{camera.lens.width, camera.lens.height};
    };
    const auto differs = [&](const ForeignRig& cameras) {
        return std::ranges::any_of(cameras.cameras, [&](const ForeignCamera& camera) {
            return size_of(camera) != size_of(cameras.cameras.front());
        });
    };
    if (undistorted.empty() || !differs(before) || differs(rig)) return;
    rig.checks.push_back(
        fmt::format("size: each camera has another size in the model, but not in its pictures; {}, "
                    "and leave --size out",
                    undistorted));
}

}  // namespace

Expected<void> compare_sizes(ForeignRig& rig, const Material& material, const Said& said) {
    std::vector<const ForeignCamera*> on_their_side;
    for (const ForeignCamera& camera : rig.cameras) {
        const auto look = material.looks.find(camera.name);
        if (look != material.looks.end() && camera.lens.width > 0 && camera.lens.height > 0 &&
            is_on_its_side(camera.lens, look->second))
            on_their_side.push_back(&camera);
    }
    if (!on_their_side.empty()) return turned(on_their_side, material);
    const ForeignRig before = rig;
    const std::string undistorted = doubt_of_undistorted(rig);
    for (ForeignCamera& camera : rig.cameras) {
        const auto look = material.looks.find(camera.name);
        if (look == material.looks.end()) continue;
        if (auto compared = compare(camera, look->second, said, rig.format, undistorted); !compared)
            return compared;
    }
    if (std::string doubt = doubt_of_shapes(before, rig); !doubt.empty())
        rig.problems.push_back(std::move(doubt));
    check_undistorted(rig, before, undistorted);
    return {};
}

}  // namespace atrium::calibrate
