// Pictures of the empty room.
#include "tools/calibrate/recording/gatherer.hpp"
#include "tools/calibrate/recording/mask_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

namespace atrium::calibrate {
namespace {

// Fewest pictures with people in them from which a site learns the empty room: as
// site_node/occupied_room/learn_occupied_room.hpp.
constexpr std::size_t kFewestToLearnFrom = 8;

std::filesystem::path first_file(const Shots& shots) {
    return shots.is_video ? shots.path : shots.pictures.begin()->second;
}

// The pictures of an empty room have no instants, and a site reads them one after another.
void count_without_gaps(Shots& room) {
    std::map<std::size_t, std::filesystem::path> counted;
    for (auto& [number, file] : room.pictures) counted.emplace(counted.size(), std::move(file));
    room.pictures = std::move(counted);
}

}  // namespace

Expected<void> Gatherer::gather_backgrounds() {
    if (!folders_.background.empty()) {
        auto named = find_shots(folders_.background);
        if (!named) return tl::unexpected(named.error());
        rooms_ = std::move(*named);
        std::error_code failure;
        if (std::filesystem::equivalent(folders_.background, folders_.frames, failure) &&
            std::ranges::none_of(rooms_, &Shots::is_background)) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("--background: {} is the folder of the recording, and no "
                                          "name in it says which pictures show the empty room; "
                                          "give a folder of the empty room alone",
                                          folders_.background.string()));
        }
        if (std::ranges::any_of(rooms_, &Shots::is_background))
            std::erase_if(rooms_, [](const Shots& shots) { return !shots.is_background; });
    }
    // a static trial shows a person more often than not
    if (std::ranges::any_of(rooms_, [](const Shots& shots) { return !shots.is_static; }))
        std::erase_if(rooms_, [](const Shots& shots) { return shots.is_static; });
    auto matches = match_shots(
        with_frames_, rooms_, names_, "name the folder of one empty room with --background");
    if (!matches) return make_error(matches.error().kind, "background: " + matches.error().message);
    if (auto read = read_rooms_one_by_one(*matches); !read) return read;
    material_.backgrounds = std::move(matches->by_camera);
    for (auto& [camera, room] : material_.backgrounds) count_without_gaps(room);
    if (!material_.masks.empty()) return {};
    if (auto fitting = check_background_sizes(material_); !fitting) return fitting;
    if (auto other = check_that_rooms_differ(); !other) return other;
    report_found_rooms();
    if (!matches->missing.empty()) report_backgrounds(matches->missing);
    return {};
}

RoomOwners Gatherer::room_owners() const {
    RoomOwners owners{cameras_, names_};
    for (const auto& [camera, reason] : folders_.left_out) owners.cameras.push_back(camera);
    std::ranges::copy(folders_.walked, std::back_inserter(owners.cameras));
    return owners;
}

// 01.jpg, 02.jpg, ... may be a picture of each camera. Where folders fit few cameras, and by their
// numbers only, that is the likelier reading: background1f is no folder of camera 1.
Expected<void> Gatherer::read_rooms_one_by_one(Matches& matches) {
    if (2 * matches.by_camera.size() > with_frames_.size()) return {};
    const RoomOwners owners = room_owners();
    auto single = pair_single_rooms(material_, rooms_, owners);
    if (!single) return make_error(single.error().kind, "background: " + single.error().message);
    if (single->size() > matches.by_camera.size()) {
        matches.by_camera = std::move(*single);
    } else {
        std::erase_if(matches.by_camera, [&](const auto& entry) {
            return may_be_one_per_camera(material_, entry.second, owners);
        });
    }
    matches.missing.clear();
    std::ranges::copy_if(
        with_frames_, std::back_inserter(matches.missing), [&](const std::string& camera) {
            return !matches.by_camera.contains(camera);
        });
    return {};
}

// The pictures of a recording that somebody gives as the empty room, perhaps through links.
Expected<void> Gatherer::check_that_rooms_differ() const {
    for (const auto& [camera, room] : material_.backgrounds) {
        const Shots& frames = material_.frames.at(camera);
        std::error_code failure;
        if (room.is_video != frames.is_video ||
            !std::filesystem::equivalent(first_file(room), first_file(frames), failure))
            continue;
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("background: {} is the recording of camera '{}' itself; give "
                                      "pictures of the empty room, or leave --background out",
                                      first_file(room).string(),
                                      known_name(camera, folders_.originals)));
    }
    return {};
}

void Gatherer::report_found_rooms() {
    if (material_.backgrounds.empty()) return;
    const std::size_t num_found = material_.backgrounds.size();
    const Shots& some = material_.backgrounds.begin()->second;
    std::string files =
        fmt::format("'{}'", some.is_video ? first_file(some).filename().string() : some.label);
    if (num_found > 1) files += fmt::format(" and those of {} more cameras", num_found - 1);
    if (some.is_static && folders_.background.empty()) {
        check(
            fmt::format("background: {} are taken as the empty room because of the word static in "
                        "their names. A static trial usually shows a person: if it does, give the "
                        "empty room with --background, or let the site learn it from the video: "
                        "site_node --segmentation.background_from people (docs/backgrounds.md)",
                        files));
    } else if (num_found == material_.frames.size()) {
        tell(fmt::format("background: the empty room was found for every camera: {}", files));
    } else {
        tell(fmt::format("background: the empty room was found for {} of {} cameras: {}",
                         num_found,
                         material_.frames.size(),
                         files));
    }
}

void Gatherer::report_backgrounds(const std::vector<std::string>& without) {
    const bool is_named = !folders_.background.empty();
    std::string missing = known(without);
    std::string cure =
        "film the empty room with the same cameras and give its folder with --background, or give "
        "masks of the people with --masks";
    if (material_.backgrounds.empty() && (is_named || !rooms_.empty())) {
        missing += why_no_room_fits((is_named ? folders_.background : folders_.frames).string(),
                                    material_,
                                    rooms_,
                                    room_owners());
        if (!rooms_.empty()) cure = "give these files such names, or " + cure;
    }
    // a video's number of pictures may be unknown
    if (fewest_ > 0 && fewest_ < kFewestToLearnFrom) {
        problem(
            fmt::format("background: no empty room of {}, and {} per camera is too few to "
                        "learn it from ({}): site_node will end with an error; {}",
                        missing,
                        counted(fewest_, "picture"),
                        kFewestToLearnFrom,
                        cure));
        return;
    }
    std::string text = fmt::format(
        "background: no empty room of {}: the site learns it from the pictures with "
        "people, which works where people move; for better outlines {}",
        missing,
        cure);
    // a folder that the user names is meant to be used
    if (is_named && material_.backgrounds.empty()) {
        problem(std::move(text));
    } else {
        check(std::move(text));
    }
}

}  // namespace atrium::calibrate
