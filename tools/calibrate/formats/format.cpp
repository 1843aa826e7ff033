#include "tools/calibrate/formats/format.hpp"

#include "tools/calibrate/formats/folder_files.hpp"
#include "tools/calibrate/formats/unread_formats.hpp"
#include "tools/calibrate/names/name_parts.hpp"
#include "tools/calibrate/names/rig_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

bool is_colmap(const fs::path& file) {
    const std::string name = file.filename().string();
    std::error_code failure;
    return fs::is_directory(file, failure) || suffix_of(file) == ".bin" || name == "cameras.txt" ||
           name == "images.txt";
}

// Finds the format from the first file's name and content.
Expected<Format> guess(const fs::path& file) {
    if (is_colmap(file)) return Format::kColmap;
    const auto text = read_bytes(file, kMaxTextBytes);
    if (!text) return tl::unexpected(text.error());
    if (text->starts_with("\xFF\xFE") || text->starts_with("\xFE\xFF")) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{0}: is text in UTF-16; write a copy in UTF-8, for example "
                                      "with `iconv -f UTF-16 -t UTF-8 {0} > copy{1}`",
                                      file.string(),
                                      file.extension().string()));
    }
    const auto has = [&](const char* word) { return text->find(word) != std::string::npos; };
    const std::size_t first = text->find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    const char start = first == std::string::npos ? '\0' : (*text)[first];
    if (const std::string unread = unread_format(*text); !unread.empty()) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format(
                "{}: {}; read are {}", file.string(), unread, fmt::join(format_names(), ", ")));
    }
    if (start == '<') {
        if (has("<opencv_storage")) return Format::kOpenCv;
        if (has("<calibration") && has("<intrinsic")) return Format::kQualisys;
        if (has("<Cameras") && has("<KeyFrame")) return Format::kVicon;
    } else if (suffix_of(file) == ".toml" || (has("matrix = ") && has("distortions = "))) {
        return Format::kToml;
    } else if (has("distortion_coeffs") && has("camera_model")) {
        return Format::kKalibr;
    } else if (start == '{' || start == '[' || start == '%' || suffix_of(file) == ".yml" ||
               suffix_of(file) == ".yaml") {
        return Format::kOpenCv;
    }
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("{}: not recognised as a calibration; say what it is with "
                                  "--format: {}; of any other program: {}",
                                  file.string(),
                                  fmt::join(format_names(), ", "),
                                  kCureOfOthers));
}

Expected<ForeignRig> read(const Files& files, Format format) {
    switch (format) {
        case Format::kOpenCv:
            return read_opencv(files);
        case Format::kQualisys:
            return read_qualisys(files);
        case Format::kVicon:
            return read_vicon(files);
        case Format::kColmap:
            return read_colmap(files);
        case Format::kToml:
            return read_toml_cameras(files);
        case Format::kKalibr:
            break;
    }
    return read_kalibr(files);
}

// The cameras of which this file alone says everything.
std::vector<std::string> whole_cameras(const fs::path& file, Format format) {
    std::vector<std::string> names;
    const auto rig = read({file}, format);
    if (!rig) return names;
    for (const ForeignCamera& camera : rig->cameras)
        if (camera.has_lens && camera.pose) names.push_back(camera.name);
    return names;
}

// Files may each hold a part of one calibration, but not each a whole one of the same cameras.
Expected<void> check_one_calibration(const Files& files, Format format) {
    if (files.size() < 2 || format == Format::kColmap) return {};
    std::vector<std::vector<std::string>> names;
    for (const fs::path& file : files) names.push_back(whole_cameras(file, format));
    Files same;
    for (std::size_t i = 0; i < files.size(); ++i) {
        const auto has_any_of_mine = [&](const std::vector<std::string>& other) {
            return &other != &names[i] && other.size() > 1 && names[i].size() > 1 &&
                   std::ranges::find_first_of(other, names[i]) != other.end();
        };
        if (std::ranges::any_of(names, has_any_of_mine)) same.push_back(files[i]);
    }
    if (same.empty()) return {};
    return several_of(same, "calibrations with the same cameras", "give one of them");
}

// Names become folders and keys: A-Z a-z 0-9 _ . - of at most 63 characters.
void make_names_valid(ForeignRig& rig) {
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        const std::string original = rig.cameras[i].name;
        std::string name = rig_name(original);
        if (name.empty() || name == "." || name == "..") name = fmt::format("cam{}", i + 1);
        // neither a name that was given, nor one that another camera has in the file
        const auto is_taken = [&](const std::string& wanted) {
            return std::ranges::any_of(rig.cameras, [&](const ForeignCamera& other) {
                return other.name == wanted && (&other < &rig.cameras[i] || wanted != original);
            });
        };
        std::string free = name;
        for (int k = 2; is_taken(free); ++k) free = fmt::format("{}_{}", name.substr(0, 56), k);
        if (free != original)
            rig.notes.push_back(fmt::format("camera '{}' is called '{}' here", original, free));
        if (free != original) rig.cameras[i].original = original;
        rig.cameras[i].name = free;
    }
}

// As it is in the file, or as it is called here.
bool matches_name(const std::string& pattern, const std::string& name) {
    return fnmatch(composed(pattern).c_str(), composed(name).c_str(), 0) == 0 ||
           fnmatch(pattern.c_str(), rig_name(name).c_str(), 0) == 0;
}

bool is_exclusion(const std::string& pattern) { return pattern.starts_with('!'); }

Expected<void> select_cameras(ForeignRig& rig, const std::vector<std::string>& patterns) {
    if (patterns.empty()) return {};
    const auto matches = [](const std::string& pattern, const std::string& name) {
        return matches_name(is_exclusion(pattern) ? pattern.substr(1) : pattern, name);
    };
    for (const std::string& pattern : patterns) {
        const auto is_camera = [&](const ForeignCamera& camera) {
            return matches(pattern, camera.name);
        };
        const auto is_left_out = [&](const auto& entry) { return matches(pattern, entry.first); };
        if (std::ranges::any_of(rig.cameras, is_camera) ||
            std::ranges::any_of(rig.left_out, is_left_out))
            continue;
        constexpr std::size_t kNamed = 12;
        std::vector<std::string> names;
        for (const ForeignCamera& camera : rig.cameras) names.push_back(camera.name);
        names = in_natural_order(std::move(names));
        names.resize(std::min(names.size(), kNamed));
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("--cameras {}: no camera has this name; the calibration has "
                                      "{}{}",
                                      pattern,
                                      fmt::join(names, ", "),
                                      rig.cameras.size() > kNamed ? ", ..." : ""));
    }
    const auto is_chosen = [&](const std::string& name) {
        bool is_wanted = std::ranges::all_of(patterns, is_exclusion);
        bool is_excluded = false;
        for (const std::string& pattern : patterns) {
            if (matches(pattern, name)) (is_exclusion(pattern) ? is_excluded : is_wanted) = true;
        }
        return is_wanted && !is_excluded;
    };
    for (auto& [name, reason] : rig.left_out)
        if (!is_chosen(name)) reason.clear();
    for (const ForeignCamera& camera : rig.cameras)
        if (!is_chosen(camera.name)) rig.left_out[camera.name] = "";
    keep_cameras(rig, is_chosen);
    return {};
}

// A camera of a rig stands still. One that was carried about, such as a phone that helped COLMAP,
// is left out if a rig remains without it.
void sort_out_moved(ForeignRig& rig) {
    constexpr double kCarried = 0.1;  // more than the noise of any useful one
    const auto is_carried = [](const ForeignCamera& camera) { return camera.spread > kCarried; };
    const auto num_carried =
        static_cast<std::size_t>(std::ranges::count_if(rig.cameras, is_carried));
    const bool is_rig_left = rig.cameras.size() >= num_carried + 2;
    for (const ForeignCamera& camera : rig.cameras) {
        if (camera.spread <= kStillSpread) continue;
        const std::string what =
            fmt::format("camera '{}': its {} images stand up to {:.1f} % of the rig's size apart",
                        camera.name,
                        camera.num_images,
                        100.0 * camera.spread);
        if (is_rig_left && is_carried(camera)) {
            rig.walked.push_back(
                {camera.name,
                 fmt::format("{}, so it moved: left out, because the cameras of a rig stand still; "
                             "if that is right, say --cameras '!{}'; if it stood still, COLMAP "
                             "erred: solve again with more pictures",
                             what,
                             camera.name)});
        } else {
            rig.checks.push_back(
                fmt::format("{}, so it moved, or COLMAP erred; the first is used; if the person "
                            "is broken, leave it out: --cameras '!{}'",
                            what,
                            camera.name));
        }
    }
    if (is_rig_left) std::erase_if(rig.cameras, is_carried);
}

tl::unexpected<Error> incomplete(const ForeignRig& rig, const std::string& where) {
    std::vector<std::string> no_lens;
    std::vector<std::string> no_pose;
    for (const ForeignCamera& camera : rig.cameras) {
        if (!camera.has_lens) no_lens.push_back(camera.name);
        if (!camera.pose) no_pose.push_back(camera.name);
    }
    std::string text = fmt::format("{}: {}:", where, rig.format);
    if (!no_lens.empty())
        text += fmt::format(" no camera matrix of {};", fmt::join(in_natural_order(no_lens), ", "));
    if (!no_pose.empty())
        text += fmt::format(" no rotation and translation of {};",
                            fmt::join(in_natural_order(no_pose), ", "));
    text += " give all files of the calibration, the intrinsics and the extrinsics of each camera";
    std::vector<std::string> whole, broken;
    for (const ForeignCamera& camera : rig.cameras)
        (camera.has_lens && camera.pose ? whole : broken).push_back("!" + camera.name);
    if (whole.size() >= 2)
        text += fmt::format("; if they could not be calibrated, leave them out: --cameras '{}'",
                            fmt::join(in_natural_order(broken), ","));
    for (const std::string& problem : rig.problems) text += "; " + problem;
    return make_error(ErrorKind::kConfiguration, text);
}

}  // namespace

const std::vector<std::string>& format_names() {
    static const std::vector<std::string> names{
        "opencv", "qualisys", "vicon", "colmap", "caliscope", "pose2sim", "anipose", "kalibr"};
    return names;
}

std::optional<Format> format_of(const std::string& name) {
    if (name == "opencv") return Format::kOpenCv;
    if (name == "qualisys") return Format::kQualisys;
    if (name == "vicon") return Format::kVicon;
    if (name == "colmap") return Format::kColmap;
    if (name == "kalibr") return Format::kKalibr;
    if (name == "caliscope" || name == "pose2sim" || name == "anipose") return Format::kToml;
    return std::nullopt;
}

tl::unexpected<Error> too_many_cameras(const std::string& where) {
    return make_error(
        ErrorKind::kInvalidData,
        fmt::format(
            "{}: more than {} cameras; give the files of one room", where, kMaxCamerasRead));
}

void keep_cameras(ForeignRig& rig, const std::function<bool(const std::string&)>& is_wanted) {
    for (const ForeignCamera& camera : rig.cameras) {
        if (is_wanted(camera.name)) continue;
        const std::string start = fmt::format("camera '{}'", camera.known_name());
        const auto is_of_camera = [&](const std::string& line) { return line.starts_with(start); };
        std::erase_if(rig.notes, is_of_camera);
        std::erase_if(rig.checks, is_of_camera);
    }
    std::erase_if(rig.cameras,
                  [&](const ForeignCamera& camera) { return !is_wanted(camera.name); });
}

Expected<ForeignRig> read_foreign(const Files& files,
                                  const std::string& format,
                                  const std::vector<std::string>& wanted) {
    std::optional<Format> known = format_of(format);
    for (const fs::path& file : files) {
        if (format_of(format)) break;
        const auto guessed = guess(file);
        if (!guessed && known) continue;  // its reader says what is wrong
        if (!guessed) return tl::unexpected(guessed.error());
        if (known && *known != *guessed) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("{} and {} are of different formats; give the files of "
                                          "one calibration",
                                          files.front().string(),
                                          file.string()));
        }
        known = *guessed;
    }
    if (auto one = check_one_calibration(files, *known); !one) return tl::unexpected(one.error());
    auto rig = read(files, *known);
    if (!rig) return rig;
    const std::string where = files.front().string();
    if (rig->cameras.size() > kMaxCamerasRead) return too_many_cameras(where);
    if (auto selected = select_cameras(*rig, wanted); !selected)
        return tl::unexpected(selected.error());
    sort_out_moved(*rig);
    if (rig->cameras.size() < 2) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: {} cameras found as {}{}; a rig has 2 to {}: give the files of all "
                        "cameras, or another --{}{}{}{}",
                        where,
                        rig->cameras.size(),
                        rig->format,
                        wanted.empty() ? "" : " with the names of --cameras",
                        kMaxCameras,
                        wanted.empty() ? "format" : "cameras",
                        rig->cameras.empty() && wanted.empty()
                            ? fmt::format("; of any other program: {}", kCureOfOthers)
                            : "",
                        rig->problems.empty() ? "" : "; ",
                        fmt::join(rig->problems, "; ")));
    }
    const bool is_complete = std::ranges::all_of(rig->cameras, [](const ForeignCamera& camera) {
        return camera.has_lens && camera.pose.has_value();
    });
    if (!is_complete) return incomplete(*rig, where);
    for (const ForeignCamera& camera : rig->cameras) {
        if (camera.pose->vector.cwiseAbs().maxCoeff() <= 1e9) continue;
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: camera '{}' is absurdly far away", where, camera.name));
    }
    make_names_valid(*rig);
    return rig;
}

}  // namespace atrium::calibrate
