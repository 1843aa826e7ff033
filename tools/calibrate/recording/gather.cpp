#include "tools/calibrate/recording/gather.hpp"

#include "tools/calibrate/recording/counting.hpp"
#include "tools/calibrate/recording/gatherer.hpp"
#include "tools/calibrate/recording/mask_checks.hpp"
#include "tools/calibrate/recording/takes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

// Whether pictures were found in `folder`, below `root`. Links are as they are named: those of a
// recording may lead into the folder of the empty room.
bool is_in_folder(const Shots& shots, const fs::path& folder, const fs::path& root) {
    if (folder.empty()) return false;
    std::error_code failure;
    const fs::path relative = shots.path.lexically_relative(root);
    fs::path at = root;
    for (const fs::path& part : relative) {
        at /= part;
        if (part != "." && fs::equivalent(at, folder, failure)) return true;
    }
    return false;
}

}  // namespace

Expected<Material> Gatherer::run() {
    const auto found = find_shots(folders_.frames);
    if (!found) return tl::unexpected(found.error());
    if (auto done = sort_out(*found); !done) return tl::unexpected(done.error());
    if (auto done = gather_frames(); !done) return tl::unexpected(done.error());
    if (auto done = drop_other_names(); !done) return tl::unexpected(done.error());
    take_times();
    drop_other_instants();
    take_numbering();
    if (auto done = look_at_all(); !done) return tl::unexpected(done.error());
    if (auto done = compare_numbers(); !done) return tl::unexpected(done.error());
    if (folders_.compare) {
        if (auto done = folders_.compare(material_); !done) return tl::unexpected(done.error());
    }
    if (auto done = gather_masks(); !done) return tl::unexpected(done.error());
    if (auto done = gather_backgrounds(); !done) return tl::unexpected(done.error());
    return std::move(material_);
}

// Pictures in folders that the user names for another purpose, and of other takes, are no frames.
Expected<void> Gatherer::sort_out(const std::vector<Shots>& found) {
    const std::string& take = folders_.take;
    const auto is_of = [&](const Shots& shots) { return is_of_take(take, shots.label); };
    std::vector<Shots> all;
    std::ranges::copy_if(found, std::back_inserter(all), [&](const Shots& shots) {
        return !is_in_folder(shots, folders_.masks, folders_.frames) &&
               !is_in_folder(shots, folders_.background, folders_.frames);
    });
    for (const Shots& shots : all) {
        // who asks for a static trial by name does not mean the empty room
        const bool is_asked_for = !take.empty() && is_of(shots) && names_empty_room(take);
        if (shots.is_mask) {
            masks_.push_back(shots);
        } else if (shots.is_background && !is_asked_for) {
            rooms_.push_back(shots);
        } else if (take.empty() || is_of(shots)) {
            frames_.push_back(shots);
        }
    }
    if (take.empty()) return {};
    for (std::vector<Shots>* others : {&rooms_, &masks_}) {
        if (std::ranges::any_of(*others, is_of))
            std::erase_if(*others, [&](const Shots& shots) { return !is_of(shots); });
    }
    if (!frames_.empty()) return {};
    const std::vector<std::string> names = beginnings(known_names(cameras_), all);
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("--take '{}': no folder and no file below {} has such a name{}",
                                  take,
                                  folders_.frames.string(),
                                  names.empty() ? "" : "; there are " + listed(names)));
}

// Several takes in one folder are the likeliest reason.
std::string Gatherer::cure_of_two() const {
    const std::vector<std::string> names = beginnings(known_names(cameras_), frames_);
    if (names.size() < 2) return kCureOfTwo;
    return fmt::format("choose one recording: --take {}; or {}", listed(names), kCureOfTwo);
}

bool Gatherer::has_name(const std::string& camera, const Shots& shots) const {
    return likeness(known_name(camera, folders_.originals), shots.label, {}) >= kByName;
}

// Returns the labels of those that are no masks and no empty room.
std::vector<std::string> Gatherer::drop_pictures_of(const std::string& other) {
    const auto is_of_other = [&](const Shots& shots) {
        return has_name(other, shots) && std::ranges::none_of(cameras_, [&](const auto& camera) {
                   return has_name(camera, shots);
               });
    };
    std::vector<std::string> labels;
    for (const Shots& shots : frames_)
        if (is_of_other(shots)) labels.push_back(shots.label);
    for (std::vector<Shots>* shots : {&frames_, &rooms_, &masks_})
        std::erase_if(*shots, is_of_other);
    return labels;
}

// Pictures of a camera that is not of the rig are those of no other one.
void Gatherer::drop_others() {
    for (const std::string& walked : folders_.walked)
        if (drop_pictures_of(walked).empty()) material_.left_out.push_back(walked);
    for (const auto& [camera, reason] : folders_.left_out) {
        const std::vector<std::string> labels = drop_pictures_of(camera);
        if (labels.empty() || reason.empty()) continue;
        problem(
            fmt::format("camera '{0}' left out, although it has pictures ('{1}'): {2}; or say "
                        "--cameras '!{0}'; a hull from fewer cameras is thicker",
                        camera,
                        labels.front(),
                        reason));
    }
}

Expected<void> Gatherer::gather_frames() {
    drop_others();
    ShiftedCount shifted = find_shifted_count(cameras_, frames_, folders_.originals);
    if (!shifted.names.empty()) {
        check(
            fmt::format("cameras: {}: the calibration and the pictures count from 0 and from 1, so "
                        "they are paired in order; if that is wrong, give the pictures the names "
                        "of the cameras",
                        shifted.pairing));
    }
    names_ = shifted.names.empty() ? folders_.originals : std::move(shifted.names);
    auto matches = match_shots(cameras_, frames_, names_, cure_of_two());
    if (!matches) return tl::unexpected(matches.error());
    material_.frames = std::move(matches->by_camera);
    take_missing(matches->missing);
    std::vector<std::string> labels;
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
    report_missing(labels);
    return {};
}

void Gatherer::take_missing(const std::vector<std::string>& cameras) {
    std::vector<std::string> for_markers;
    for (const std::string& camera : cameras) {
        if (folders_.for_markers.contains(camera)) {
            for_markers.push_back(camera);
        } else {
            const bool is_optional =
                std::ranges::find(folders_.optional, camera) != folders_.optional.end();
            (is_optional ? material_.left_out : material_.missing).push_back(camera);
        }
    }
    doubt_markers(for_markers);
}

// Cameras of a model for markers without pictures: whether their pictures are missed.
void Gatherer::doubt_markers(const std::vector<std::string>& without) {
    std::map<std::string, std::vector<std::string>> of_model;
    for (const std::string& camera : without) {
        const auto is_of_camera = [&](const Shots& shots) { return has_name(camera, shots); };
        if (std::ranges::any_of(rooms_, is_of_camera) ||
            std::ranges::any_of(masks_, is_of_camera)) {
            material_.missing.push_back(camera);
            why_missed_ += fmt::format("; of '{}' there is an empty room or a mask",
                                       known_name(camera, folders_.originals));
        } else {
            of_model[folders_.for_markers.at(camera)].push_back(camera);
        }
    }
    for (const auto& [model, cameras] : of_model) {
        std::vector<std::string> with;
        for (const auto& [camera, other] : folders_.for_markers)
            if (other == model && material_.frames.contains(camera)) with.push_back(camera);
        if (with.empty()) continue;
        const std::string why = fmt::format("{} {} of the same model as {} ({})",
                                            known(cameras),
                                            cameras.size() == 1 ? "is" : "are",
                                            known(with),
                                            model);
        if (with.size() >= cameras.size()) {
            std::ranges::copy(cameras, std::back_inserter(material_.missing));
            why_missed_ += "; " + why;
        } else {
            check(
                fmt::format("cameras for markers: {}, but have no pictures in {}; if they took "
                            "some, copy them there",
                            why,
                            folders_.frames.string()));
        }
    }
}

void Gatherer::report_missing(const std::vector<std::string>& unused) {
    if (!material_.left_out.empty()) {
        tell(fmt::format("left out: {}: it moved, and has no pictures in {}",
                         known(material_.left_out),
                         folders_.frames.string()));
    }
    if (!material_.missing.empty()) {
        problem(fmt::format(
            "{} of {} cameras left out, because {} has no pictures of {}{}{}; a hull from fewer "
            "cameras is thicker: copy the pictures there, give their folder the camera's name, or "
            "leave these cameras out with --cameras",
            material_.missing.size(),
            material_.frames.size() + material_.missing.size(),
            folders_.frames.string(),
            known(material_.missing),
            (unused.empty() ? "" : " (not used: " + listed(unused) + ")") +
                doubt_of_count(known_names(cameras_), known_names(material_.missing), unused),
            why_missed_));
    }
    if (material_.missing.empty() && !unused.empty()) {
        check(
            fmt::format("pictures not used: {}; the calibration has no camera of these names, only "
                        "{}{}",
                        listed(unused),
                        known(cameras_),
                        folders_.why_unknown));
    }
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
        if (const std::string text = capture::text_of_lost_pictures(look->lost); !text.empty())
            check(fmt::format("camera '{}': {}: {}", camera, shots.path.string(), text));
        if (!shots.is_video) first = std::min(first, shots.pictures.begin()->first);
        fewest_ = std::min(fewest_, look->num_frames);
        material_.looks[camera] = *look;
    }
    compare_rates();
    if (first != std::numeric_limits<std::size_t>::max()) material_.first_frame = first;
    if (std::string doubt = doubt_of_lengths(material_.frames, material_.looks); !doubt.empty())
        check(std::move(doubt));
    if (std::string doubt = doubt_of_listed_times(material_.frames); !doubt.empty())
        check(std::move(doubt));
    const Look& look = material_.looks.begin()->second;
    if (!folders_.is_rate_said && look.codec_rate_hz > 0.0 &&
        std::abs(look.codec_rate_hz / look.rate_hz - 1.0) > 0.01) {
        check(
            fmt::format("rate: the files say {0:.4g} Hz, the pictures in them {1:.4g} Hz; "
                        "{0:.4g} Hz is taken; if people move at the wrong speed, say --rate "
                        "{1:.4g}",
                        look.rate_hz,
                        look.codec_rate_hz));
    }
    return {};
}

// A phone with numbers of its own, for example, has no instant in common with the cameras.
void Gatherer::drop_other_instants() {
    const OtherInstants others = find_other_instants(material_.frames);
    for (const std::string& camera : others.cameras) {
        const auto& pictures = material_.frames.at(camera).pictures;
        const std::string& name = known_name(camera, folders_.originals);
        const bool is_time = numbering_.times.has_value();
        problem(fmt::format(
            "camera '{0}' left out: its pictures have the {1} {2}, the others {3}, and pictures of "
            "one {4} are one instant: {5}, or say --cameras '!{0}'",
            name,
            is_time ? "times" : "numbers",
            numbering_.text(pictures.begin()->first, pictures.rbegin()->first),
            numbering_.text(others.first, others.last),
            is_time ? "time" : "number",
            is_time ? "set its clock as those of the others and record again"
                    : "give its pictures the numbers of the others"));
        material_.frames.erase(camera);
    }
    for (const auto& [camera, shots] : material_.frames) with_frames_.push_back(camera);
}

void Gatherer::take_numbering() {
    if (!numbering_.times) numbering_ = numbering_of(material_.frames);
    if (numbering_.step > 1) {
        count_by_one(material_.frames, numbering_);
        check(
            fmt::format("instants: the numbers of the pictures go in steps of {}; they are taken "
                        "as following each other, and --rate is how many there are per second",
                        numbering_.step));
    }
    if (std::string doubt = doubt_of_sparse_numbers(material_.frames, numbering_); !doubt.empty())
        problem(std::move(doubt));
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

Expected<Material> gather(const std::vector<std::string>& cameras, const PictureFolders& folders) {
    return Gatherer(cameras, folders).run();
}

}  // namespace atrium::calibrate
