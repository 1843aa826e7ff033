#include "tools/calibrate/formats/unread_formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace atrium::calibrate {
namespace {

struct UnreadFormat {
    const char* name;
    std::array<const char*, 3> words;  // all of them are in its files
    const char* hint;                  // before the cure of all
};

constexpr const char* kCentres =
    "a centre is t_wc, beside R_cw or R_wc, and principal points may stay offsets from the "
    "middle: ";
constexpr std::array<UnreadFormat, 8> kFormats{
    {{"a transforms.json of NeRF or Blender",
      {"\"transform_matrix\"", "\"frames\"", "{"},
      "give the model of COLMAP from which it was made (sparse/0), or "},
     {"an .sfm file of Meshroom (AliceVision)",
      {"\"views\"", "\"poseId\"", "\"intrinsics\""},
      kCentres},
     {"an sfm_data.json of OpenMVG", {"\"sfm_data_version\"", "\"intrinsics\"", "{"}, kCentres},
     {"poses of ROS (tf)",
      {"transform", "child_frame_id", "rotation"},
      "turn each quaternion into a matrix; the files of camera_info give the lenses: "},
     {"an XML file of Metashape", {"<document", "<sensor", "<camera"}, kCentres},
     {"a table of RealityCapture", {"#name", "heading", "roll"}, ""},
     {"a bundle.out of Bundler", {"# Bundle file", "", ""}, ""},
     {"an .nvm file of VisualSFM", {"NVM_V3", "", ""}, ""}}};

}  // namespace

const char* const kCureOfOthers =
    "write it as YAML or JSON of OpenCV, for each camera camera_matrix, distortion, image_width, "
    "image_height, R and T (docs/calibrate.md)";

std::string unread_format(std::string_view text) {
    const auto is_one = [&](const UnreadFormat& format) {
        return std::ranges::all_of(format.words, [&](const char* word) {
            return text.find(word) != std::string_view::npos;
        });
    };
    const auto* const found = std::ranges::find_if(kFormats, is_one);
    if (found == kFormats.end()) return {};
    return fmt::format(
        "{}, a format that is not read; {}{}", found->name, found->hint, kCureOfOthers);
}

}  // namespace atrium::calibrate
