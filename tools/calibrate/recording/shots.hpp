#pragma once

#include "core/base/expected.hpp"
#include "site_node/capture/lost_pictures.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// Pictures as other programs lay them out in folders, and a recording made of them.
namespace atrium::calibrate {

/// The pictures of one camera: a video, or files with numbers.
struct Shots {
    std::filesystem::path path;  // the video, or the folder of the pictures
    bool is_video = false;
    std::map<std::size_t, std::filesystem::path> pictures;  // by number; empty for a video
    /// Path below the searched folder without the numbers: what names the camera.
    std::string label;
    std::string time_unit = {};  // "milliseconds", ...: the numbers are times in nanoseconds
    bool is_alone = false;       // one picture out of a folder that may also be a sequence
    bool is_background = false;  // by a word in its label: "empty", "bg", ...
    bool is_static = false;      // the same, by the word "static" alone: may show a person
    bool is_mask = false;        // by a word in its label: "masks", "silhouettes", ...

    /// Number of pictures; 0 for a video.
    std::size_t num_pictures() const { return pictures.size(); }
};

/// Whether a word in a label or pattern names the empty room.
bool names_empty_room(const std::string& label);

/// Finds everything below `folder` that may be the pictures of a camera, four folders deep.
/// Errors: kNotFound without such a folder, kConfiguration for a file, kInvalidData for more than
/// 200,000 files.
Expected<std::vector<Shots>> find_shots(const std::filesystem::path& folder);

/// The first picture, and the numbers of pictures.
struct Look {
    int width = 0;
    int height = 0;
    double rate_hz = 0.0;           // of a video, as the file's headers say; 0: unknown
    double codec_rate_hz = 0.0;     // the same, as the pictures say (codec_rate.hpp); 0: unknown
    std::size_t num_frames = 0;     // a video's may be wrong
    std::size_t num_in_header = 0;  // more than `num_frames` if a video is truncated
    int rotation_deg = 0;           // of a video: clockwise, by its tag; already applied
    capture::LostPictures lost{};   // of a video
};
/// Opens the first picture. Error kInvalidData if it cannot be decoded, with cause and cure.
Expected<Look> look_at(const Shots& shots);

/// What is wrong with pictures or a video that end too early, as after an interrupted copy, and the
/// cure; empty if none does. `look` is of the same shots; masks have none.
std::string doubt_of_truncation(const Shots& shots, const Look& look = {});

}  // namespace atrium::calibrate
