#include "tools/calibrate/recording/gather.hpp"

#include "tools/calibrate/recording/instants.hpp"
#include "tools/calibrate/recording/mask_checks.hpp"
#include "tools/calibrate/recording/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

// Fewest pictures with people in them from which a site learns the empty room: as
// site_node/occupied_room/learn_occupied_room.hpp.
constexpr std::size_t kFewestToLearnFrom = 8;

bool is_below(const fs::path& path, const fs::path& folder) {
    std::error_code failure;
    if (folder.empty()) return false;
    const std::string relative = fs::weakly_canonical(path, failure)
                                     .lexically_relative(fs::weakly_canonical(folder))
                                     .string();
    return !relative.empty() && !relative.starts_with("..");
}

// Finds and matches the pictures of one rig step by step; each step leaves its sentences.
class Gatherer {
public:
    Gatherer(const std::vector<std::string>& cameras, const PictureFolders& folders)
        : cameras_(cameras), folders_(folders) {}

    Expected<Material> run() {
        const auto found = find_shots(folders_.frames);
        if (!found) return tl::unexpected(found.error());
        sort_out(*found);
        if (auto done = gather_frames(); !done) return tl::unexpected(done.error());
        take_numbering();
        if (auto done = look_at_all(); !done) return tl::unexpected(done.error());
        if (auto done = compare_numbers(); !done) return tl::unexpected(done.error());
        if (auto done = gather_masks(); !done) return tl::unexpected(done.error());
        if (auto done = gather_backgrounds(); !done) return tl::unexpected(done.error());
        return std::move(material_);
    }

private:
    void sort_out(const std::vector<Shots>& found);
    Expected<void> gather_frames();
    void take_numbering();
    Expected<void> look_at_all();
    Expected<void> compare_numbers();
    void report_truncated(const std::string& camera, const std::string& doubt);
    Expected<void> gather_masks();
    Expected<void> align_masks();
    Expected<void> gather_backgrounds();
    void report_backgrounds(const std::vector<std::string>& without);

    // the names that the user knows
    std::string known(std::vector<std::string> cameras) const {
        for (std::string& camera : cameras) camera = known_name(camera, folders_.originals);
        return listed(cameras);
    }
    void tell(std::string text) { material_.told.push_back(std::move(text)); }
    void check(std::string text) { material_.checks.push_back(std::move(text)); }
    void problem(std::string text) { material_.problems.push_back(std::move(text)); }

    const std::vector<std::string>& cameras_;
    const PictureFolders& folders_;
    std::vector<std::string> with_frames_;
    std::vector<Shots> frames_;
    std::vector<Shots> rooms_;
    std::vector<Shots> masks_;
    Numbering numbering_;                                           // of the pictures' files
    std::size_t fewest_ = std::numeric_limits<std::size_t>::max();  // pictures of a camera
    Material material_;
};

// Pictures in folders that the user names for another purpose are no frames.
void Gatherer::sort_out(const std::vector<Shots>& found) {
    std::error_code failure;
    const auto is_elsewhere = [&](const Shots& shots, const fs::path& folder) {
        return is_below(shots.path, folder) && !fs::equivalent(folder, folders_.frames, failure);
    };
    for (const Shots& shots : found) {
        if (is_elsewhere(shots, folders_.masks) || is_elsewhere(shots, folders_.background))
            continue;
        (shots.is_mask ? masks_ : shots.is_background ? rooms_ : frames_).push_back(shots);
    }
}

Expected<void> Gatherer::gather_frames() {
    auto matches = match_shots(cameras_, frames_, folders_.originals);
    if (!matches) return tl::unexpected(matches.error());
    material_.frames = std::move(matches->by_camera);
    for (const std::string& camera : matches->missing) {
        const bool is_optional =
            std::ranges::find(folders_.optional, camera) != folders_.optional.end();
        (is_optional ? material_.left_out : material_.missing).push_back(camera);
    }
    std::vector<std::string> labels;
    for (const auto& [camera, shots] : material_.frames) with_frames_.push_back(camera);
    for (const Shots& shots : frames_) {
        const bool is_taken = std::ranges::any_of(material_.frames, [&](const auto& entry) {
            const Shots& chosen = entry.second;
            return chosen.label == shots.label || (chosen.is_alone && chosen.path == shots.path);
        });
        if (!shots.is_alone && !is_taken)
            labels.push_back(shots.label.empty() ? shots.path.filename().string() : shots.label);
    }
    if (material_.frames.size() < 2) {
        std::string aside;
        if (!rooms_.empty()) aside += "; pictures of the empty room, by name: " + rooms_[0].label;
        if (!masks_.empty()) aside += "; " + why_masks_need_pictures(masks_[0]);
        const std::string own = fs::weakly_canonical(folders_.frames).filename().string();
        for (const std::string& camera : cameras_) {
            const std::string& name = known_name(camera, folders_.originals);
            if (likeness(name, own, {}) < 90) continue;
            aside += "; this looks like the folder of camera '" + name +
                     "' alone: give the one above it, which holds all cameras";
        }
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: no pictures of {}; found {}{}; give videos or folders the names of "
                        "the cameras",
                        folders_.frames.string(),
                        known(material_.missing),
                        labels.empty() ? "neither videos nor pictures" : listed(labels),
                        aside));
    }
    if (!material_.left_out.empty()) {
        tell(fmt::format("left out: {}: it moved, and has no pictures in {}",
                         known(material_.left_out),
                         folders_.frames.string()));
    }
    if (!material_.missing.empty()) {
        problem(fmt::format(
            "{} of {} cameras left out, because {} has no pictures of {}{}; a hull from fewer "
            "cameras is thicker: copy the pictures there, give their folder the camera's name, or "
            "leave these cameras out with --cameras",
            material_.missing.size(),
            cameras_.size() - material_.left_out.size(),
            folders_.frames.string(),
            known(material_.missing),
            labels.empty() ? "" : " (not used: " + listed(labels) + ")"));
    }
    if (material_.missing.empty() && !labels.empty()) {
        check(
            fmt::format("pictures not used: {}; the calibration has no camera of these names, only "
                        "{}",
                        listed(labels),
                        known(cameras_)));
    }
    return {};
}

void Gatherer::report_truncated(const std::string& camera, const std::string& doubt) {
    if (!doubt.empty()) problem(fmt::format("camera '{}': {}", camera, doubt));
}

Expected<void> Gatherer::look_at_all() {
    std::size_t first = std::numeric_limits<std::size_t>::max();
    for (const auto& [camera, shots] : material_.frames) {
        auto look = look_at(shots);
        if (!look) return tl::unexpected(look.error());
        tell(fmt::format("camera '{}': {}, {} of {}x{} px",
                         camera,
                         shots.label,
                         look->num_frames == 0 ? "video" : counted(look->num_frames, "picture"),
                         look->width,
                         look->height));
        report_truncated(camera, doubt_of_truncation(shots, *look));
        if (!shots.is_video) first = std::min(first, shots.pictures.begin()->first);
        fewest_ = std::min(fewest_, look->num_frames);
        if (look->rate_hz > 0.0) {
            if (material_.rate_hz > 0.0 &&
                std::abs(look->rate_hz / material_.rate_hz - 1.0) > 0.01) {
                problem(fmt::format(
                    "camera '{}': {:.4g} pictures per second, others {:.4g}; a hull needs pictures "
                    "of the same instants: convert the videos to one rate",
                    camera,
                    look->rate_hz,
                    material_.rate_hz));
            } else {
                material_.rate_hz = look->rate_hz;
            }
        }
        material_.looks[camera] = *look;
    }
    if (first != std::numeric_limits<std::size_t>::max()) material_.first_frame = first;
    if (std::string doubt = doubt_of_lengths(material_.frames, material_.looks); !doubt.empty())
        check(std::move(doubt));
    const Look& look = material_.looks.begin()->second;
    if (look.codec_rate_hz > 0.0 && std::abs(look.codec_rate_hz / look.rate_hz - 1.0) > 0.01) {
        check(
            fmt::format("rate: the files say {0:.4g} Hz, the pictures in them {1:.4g} Hz; "
                        "{0:.4g} Hz is taken; if people move at the wrong speed, say --rate "
                        "{1:.4g}",
                        look.rate_hz,
                        look.codec_rate_hz));
    }
    return {};
}

void Gatherer::take_numbering() {
    numbering_ = numbering_of(material_.frames);
    if (numbering_.step < 2) return;
    count_by_one(material_.frames, numbering_);
    check(
        fmt::format("instants: the numbers of the pictures go in steps of {}; they are taken as "
                    "following each other, and --rate is how many there are per second",
                    numbering_.step));
}

// Pictures of one number are one instant; a metaframe needs all cameras.
Expected<void> Gatherer::compare_numbers() {
    auto instants = compare_instants(material_.frames, numbering_);
    if (!instants) return tl::unexpected(instants.error());
    if (instants->first_complete > 0)
        material_.first_complete = instants->first_complete - material_.first_frame;
    if (!instants->doubt.empty()) check(std::move(instants->doubt));
    return {};
}

Expected<void> Gatherer::gather_masks() {
    const bool is_named = !folders_.masks.empty();
    if (is_named) {
        auto named = find_shots(folders_.masks);
        if (!named) return tl::unexpected(named.error());
        masks_ = std::move(*named);
        if (std::ranges::any_of(masks_, &Shots::is_mask))
            std::erase_if(masks_, [](const Shots& shots) { return !shots.is_mask; });
    }
    if (masks_.empty() && folders_.invert_masks) {
        return make_error(ErrorKind::kConfiguration,
                          "--invert-masks: no masks were found; give their folder with --masks");
    }
    if (masks_.empty() && !is_named) return {};
    auto matches = match_shots(with_frames_, masks_, folders_.originals);
    if (!matches) return make_error(matches.error().kind, "masks: " + matches.error().message);
    const std::string where = (is_named ? folders_.masks : folders_.frames).string();
    const auto video = std::ranges::find_if(
        matches->by_camera, [](const auto& entry) { return entry.second.is_video; });
    if (video != matches->by_camera.end()) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("masks of camera '{0}': {1} is a video, but masks must be "
                                      "pictures: ffmpeg -i {1} masks/{0}/%06d.png",
                                      video->first,
                                      video->second.path.string()));
    }
    if (!matches->missing.empty()) {
        const std::string text = fmt::format(
            "masks: {} has none of {}; a site takes masks of all cameras or of none: give the "
            "folders of the masks the names of the cameras",
            where,
            known(matches->missing));
        if (is_named) return make_error(ErrorKind::kConfiguration, text);
        problem(text);
        return {};
    }
    material_.masks = std::move(matches->by_camera);
    count_by_one(material_.masks, numbering_);
    for (const auto& [camera, shots] : material_.masks)
        report_truncated(camera + "', masks", doubt_of_truncation(shots));
    if (auto fitting = check_mask_sizes(material_); !fitting) return fitting;
    if (auto right = check_mask_values(material_, folders_.invert_masks); !right) return right;
    return align_masks();
}

// Masks usually have the numbers of their pictures; else the first mask is that of the first one.
Expected<void> Gatherer::align_masks() {
    std::size_t lowest = std::numeric_limits<std::size_t>::max();
    for (const auto& [camera, shots] : material_.masks)
        lowest = std::min(lowest, shots.pictures.begin()->first);
    const auto is_frame = [&](const std::string& camera, std::size_t index) {
        const Shots& frames = material_.frames.at(camera);
        return frames.is_video ? index < material_.looks.at(camera).num_frames
                               : frames.pictures.contains(index + material_.first_frame);
    };
    // how many pictures have a mask if `first` is the number of the first mask
    const auto num_paired = [&](const std::string& camera, std::size_t first) {
        return static_cast<std::size_t>(
            std::ranges::count_if(material_.masks.at(camera).pictures, [&](const auto& mask) {
                return mask.first >= first && is_frame(camera, mask.first - first);
            }));
    };
    std::size_t same = 0;
    std::size_t moved = 0;
    for (const auto& [camera, shots] : material_.masks) {
        same += num_paired(camera, material_.first_frame);
        moved += num_paired(camera, lowest);
    }
    material_.first_mask = moved > same ? lowest : material_.first_frame;
    if (moved > same) {
        check(
            fmt::format("masks: they are numbered from {}, the pictures from {}; both are taken "
                        "as the same instant",
                        lowest,
                        material_.first_frame));
    }
    const auto& some = material_.masks.begin()->second.pictures;
    const auto complete = std::ranges::find_if(some, [&](const auto& mask) {
        return mask.first >= material_.first_mask &&
               std::ranges::all_of(material_.masks, [&](const auto& entry) {
                   return entry.second.pictures.contains(mask.first) &&
                          is_frame(entry.first, mask.first - material_.first_mask);
               });
    });
    if (complete == some.end()) {
        return make_error(ErrorKind::kConfiguration,
                          "masks: at no instant do all cameras have a picture and a mask of the "
                          "same number; give the masks the numbers of their pictures");
    }
    material_.first_complete = complete->first - material_.first_mask;
    std::string without;
    std::size_t num_without = 0;
    for (const auto& [camera, shots] : material_.masks) {
        const std::size_t num_frames = material_.looks.at(camera).num_frames;
        const std::size_t num = num_paired(camera, material_.first_mask);
        if (num >= num_frames) continue;
        num_without += num_frames - num;
        without += fmt::format("{}{} of {} of camera '{}'",
                               without.empty() ? "" : ", ",
                               num_frames - num,
                               num_frames,
                               camera);
    }
    tell("masks: found for every camera; the site uses them and needs no empty room");
    if (num_without > 0) {
        problem(
            fmt::format("masks: pictures without a mask: {}; the site leaves these instants "
                        "out: make all masks, or remove these pictures",
                        without));
    }
    return {};
}

Expected<void> Gatherer::gather_backgrounds() {
    if (!folders_.background.empty()) {
        auto named = find_shots(folders_.background);
        if (!named) return tl::unexpected(named.error());
        rooms_ = std::move(*named);
        if (std::ranges::any_of(rooms_, &Shots::is_background))
            std::erase_if(rooms_, [](const Shots& shots) { return !shots.is_background; });
    }
    auto matches = match_shots(with_frames_, rooms_, folders_.originals);
    if (!matches) return make_error(matches.error().kind, "background: " + matches.error().message);
    material_.backgrounds = std::move(matches->by_camera);
    if (!material_.masks.empty()) return {};
    if (auto fitting = check_background_sizes(material_); !fitting) return fitting;
    if (matches->missing.empty()) {
        tell("background: the empty room was found for every camera");
    } else {
        report_backgrounds(matches->missing);
    }
    return {};
}

void Gatherer::report_backgrounds(const std::vector<std::string>& without) {
    const std::string cure =
        "film the empty room with the same cameras and give its folder with --background, or give "
        "masks of the people with --masks";
    // a video's number of pictures may be unknown
    if (fewest_ > 0 && fewest_ < kFewestToLearnFrom) {
        problem(
            fmt::format("background: no empty room of {}, and {} per camera is too few to "
                        "learn it from ({}): site_node will end with an error; {}",
                        known(without),
                        counted(fewest_, "picture"),
                        kFewestToLearnFrom,
                        cure));
        return;
    }
    check(
        fmt::format("background: no empty room of {}: the site learns it from the pictures with "
                    "people, which works where people move; for better outlines {}",
                    known(without),
                    cure));
}

}  // namespace

Expected<Material> gather(const std::vector<std::string>& cameras, const PictureFolders& folders) {
    return Gatherer(cameras, folders).run();
}

}  // namespace atrium::calibrate
