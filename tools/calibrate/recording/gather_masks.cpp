// The masks of the people.
#include "tools/calibrate/recording/gatherer.hpp"
#include "tools/calibrate/recording/mask_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace atrium::calibrate {

// The way on where masks that nobody named are not as they must be.
std::string Gatherer::without_masks() const {
    if (!folders_.masks.empty()) return {};
    return "; to import without masks, say --masks none";
}

Expected<void> Gatherer::gather_masks() {
    if (folders_.ignore_masks && !masks_.empty()) {
        tell(fmt::format("masks: '{}'{} not used, as you say",
                         masks_.front().label,
                         masks_.size() > 1 ? " and others are" : " is"));
        masks_.clear();
    }
    auto done = find_masks();
    if (done && !material_.masks.empty()) done = check_masks();
    if (done || masks_.empty()) return done;
    return make_error(done.error().kind, done.error().message + without_masks());
}

Expected<void> Gatherer::find_masks() {
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
    auto matches = match_shots(
        with_frames_, masks_, names_, "name the folder of one set of masks with --masks");
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
        problem(text + without_masks());
        return {};
    }
    material_.masks = std::move(matches->by_camera);
    return {};
}

Expected<void> Gatherer::check_masks() {
    count_by_one(material_.masks, numbering_);
    for (const auto& [camera, shots] : material_.masks)
        report_truncated(camera + "', masks", doubt_of_truncation(shots));
    if (auto fitting = check_mask_sizes(material_); !fitting) return fitting;
    read_labels();
    if (auto right = check_mask_values(material_); !right) return right;
    if (const std::string doubt = doubt_of_empty_masks(material_); !doubt.empty())
        problem(doubt + without_masks());
    return align_masks();
}

// All masks are read in the way that these few show.
void Gatherer::read_labels() {
    constexpr std::size_t kMostMasks = 48;
    const std::size_t most = std::max<std::size_t>(kMostMasks / material_.masks.size(), 1);
    const MaskLabels found = find_labels(some_masks(material_, most));
    material_.mask_reading = {found.are_labels, folders_.invert_masks};
    if (!found.are_labels) return;
    tell(
        fmt::format("masks: labels of people or of parts of the body ({} {}): all but {} are "
                    "people, and the recording gets plain masks",
                    found.num_labels,
                    found.have_palette ? "in a palette" : "numbers or colours",
                    found.have_palette ? "the palette's first colour" : "0"));
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
                        "out: make all masks, or remove these pictures{}",
                        without,
                        without_masks()));
    }
    return {};
}

}  // namespace atrium::calibrate
