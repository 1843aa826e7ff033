#include "tools/calibrate/recording/mask_checks.hpp"

#include "site_node/capture/mask_file.hpp"
#include "site_node/capture/mask_values.hpp"
#include "tools/calibrate/recording/words.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cstdint>

namespace atrium::calibrate {

namespace {

bool are_swapped(const Look& one, const Look& other) {
    return one.width == other.height && one.height == other.width;
}

// A command that writes changed copies of a camera's masks below `folder`.
std::string copying(const Material& material,
                    const std::string& camera,
                    const std::string& folder,
                    const std::string& change) {
    const Shots& shots = material.masks.at(camera);
    const std::filesystem::path example = shots.pictures.begin()->second;
    const bool is_shared = std::ranges::any_of(material.masks, [&](const auto& entry) {
        return entry.first != camera && entry.second.path == shots.path;
    });
    return fmt::format("mkdir -p {0} && mogrify -path {0} {1} {2}/*{3}",
                       quoted(is_shared ? folder : folder + "/" + camera),
                       change,
                       quoted(example.parent_path().string()),
                       example.extension().string());
}

// What to do with masks of the wrong size.
std::string resizing(const Material& material,
                     const std::string& camera,
                     const Look& mask,
                     bool all_are_wrong) {
    const Look& frame = material.looks.at(camera);
    const std::string rest =
        all_are_wrong ? "" : "copy the masks of the other cameras beside them, ";
    if (are_swapped(mask, frame)) {
        return fmt::format(
            "they are on their side: make them again from the pictures, or write turned copies: {} "
            "(-rotate 270 if they are then upside down), {}and import again with --masks turned",
            copying(material, camera, "turned", "-rotate 90"),
            rest);
    }
    return fmt::format(
        "write scaled copies without smoothing, camera by camera: {}, {}and import again with "
        "--masks scaled",
        copying(material,
                camera,
                "scaled",
                fmt::format("-filter point -resize '{}x{}!'", frame.width, frame.height)),
        rest);
}

}  // namespace

Expected<void> check_mask_sizes(const Material& material) {
    std::vector<std::string> wrong;
    Look mask_of_first;
    for (const auto& [camera, shots] : material.masks) {
        const auto mask = look_at(shots);
        if (!mask) return tl::unexpected(mask.error());
        const Look& frame = material.looks.at(camera);
        if (mask->width == frame.width && mask->height == frame.height) continue;
        if (wrong.empty()) mask_of_first = *mask;
        wrong.push_back(camera);
    }
    if (wrong.empty()) return {};
    const std::string& camera = wrong.front();
    const Look& frame = material.looks.at(camera);
    return make_error(
        ErrorKind::kConfiguration,
        fmt::format(
            "masks of {} have another size than the pictures: those of '{}' have {}x{} px, "
            "its pictures {}x{}; {}",
            listed(wrong),
            camera,
            mask_of_first.width,
            mask_of_first.height,
            frame.width,
            frame.height,
            resizing(material, camera, mask_of_first, wrong.size() == material.masks.size())));
}

Expected<void> check_background_sizes(const Material& material) {
    std::vector<std::string> wrong;
    std::string first;
    for (const auto& [camera, shots] : material.backgrounds) {
        const auto room = look_at(shots);
        if (!room) return tl::unexpected(room.error());
        const Look& frame = material.looks.at(camera);
        // as a site reads them, without an odd last row or column
        if (room->width / 2 == frame.width / 2 && room->height / 2 == frame.height / 2) continue;
        wrong.push_back(camera);
        if (!first.empty()) continue;
        const auto& file = shots.is_video ? shots.path : shots.pictures.begin()->second;
        first = fmt::format(
            "{} has {}x{} px, the pictures of '{}' {}x{}; film the empty room with the same "
            "settings of the camera, or {} copies as a whole, and import again",
            file.string(),
            room->width,
            room->height,
            camera,
            frame.width,
            frame.height,
            are_swapped(*room, frame) ? "turn" : "scale");
    }
    if (wrong.empty()) return {};
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("background: the empty room of {} has another size than the "
                                  "pictures: {}",
                                  listed(wrong),
                                  first));
}

std::vector<std::filesystem::path> some_masks(const Material& material, std::size_t most) {
    std::vector<std::filesystem::path> files;
    for (const auto& [camera, shots] : material.masks) {
        std::size_t at = 0;
        std::size_t num_of_camera = 0;
        for (const auto& [number, file] : shots.pictures) {
            if (at++ * most < num_of_camera * shots.pictures.size()) continue;
            ++num_of_camera;
            files.push_back(file);
        }
    }
    return files;
}

namespace {

Expected<void> check_colours(const Material& material) {
    for (const auto& [camera, shots] : material.masks) {
        const std::string file = shots.pictures.begin()->second.string();
        const cv::Mat picture = cv::imread(file, cv::IMREAD_UNCHANGED);
        if (!capture::is_in_colours(picture)) continue;
        if (const std::string reason = why_no_labels(file); !reason.empty()) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("masks: {} has a palette, but is no mask of numbers: {}. Write masks "
                            "with people in white on black, or with 0 as the background",
                            file,
                            reason));
        }
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("masks: {} is a picture in colours, not a mask: people must be white on "
                        "black, or the rest transparent. Give the folder of the masks with "
                        "--masks, or write cut-outs as PNG with alpha",
                        file));
    }
    return {};
}

}  // namespace

Expected<void> check_mask_values(const Material& material) {
    const MaskReading& reading = material.mask_reading;
    if (!reading.labels) {
        if (auto right = check_colours(material); !right) return right;
    }
    for (const auto& [camera, shots] : material.masks) {
        const auto mask = read_mask(shots.pictures.begin()->second, reading);
        if (!mask) return tl::unexpected(mask.error());
        // one camera may be close to somebody, all of them cannot
        if (!capture::looks_inverted(*mask)) return {};
    }
    if (material.masks.empty()) return {};
    const std::string example = material.masks.begin()->second.pictures.begin()->second.string();
    return make_error(
        ErrorKind::kConfiguration,
        reading.inverted
            ? fmt::format("masks: people are white already, as they must be (for example {}): "
                          "leave --invert-masks out, and import again",
                          example)
            : fmt::format("masks: they look inverted (for example {}): white covers the "
                          "borders of the pictures, but people must be white: say "
                          "--invert-masks, and import again",
                          example));
}

std::string doubt_of_empty_masks(const Material& material) {
    constexpr std::size_t kMostMasks = 6;
    std::size_t num_read = 0;
    for (const std::filesystem::path& file : some_masks(material, kMostMasks)) {
        const auto mask = read_mask(file, material.mask_reading);
        if (!mask) continue;  // told elsewhere
        ++num_read;
        if (std::ranges::find(mask->data, std::uint8_t{255}) != mask->data.end()) return {};
    }
    if (num_read == 0) return {};
    return fmt::format(
        "masks: none of {} that were looked at shows anybody (for example {}): people must be "
        "brighter than half of the largest value, or have another number than 0 where a mask has "
        "at most eight, or at most 64 with 0 along most of the border (docs/backgrounds.md)",
        num_read,
        material.masks.begin()->second.pictures.begin()->second.string());
}

std::string why_masks_need_pictures(const Shots& masks) {
    return fmt::format(
        "there are masks ('{}'), but people get their colours from the pictures: give the folder "
        "of the pictures with --recording, and that of the masks with --masks",
        masks.label);
}

}  // namespace atrium::calibrate
