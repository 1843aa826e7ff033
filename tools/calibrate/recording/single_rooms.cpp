#include "tools/calibrate/recording/single_rooms.hpp"

#include "tools/calibrate/names/name_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using Rooms = std::map<std::string, Shots>;  // by camera
using Size = std::pair<int, int>;            // without an odd last row or column

constexpr int kByWords = 80;  // likeness of names; a number alone has less, even if it is the name

Size size_of(const Look& look) { return {look.width / 2, look.height / 2}; }

std::string last_part(const std::string& label) {
    const std::vector<std::string> parts = parts_of(label);
    return parts.empty() ? std::string() : parts.back();
}

// Of the folder of single pictures, or of a sequence.
bool has_camera_in_path(const Shots& room, const RoomOwners& owners) {
    const std::string below =
        room.is_alone ? fs::path(room.label).parent_path().string() : room.label;
    const std::string label = below.empty() ? room.path.filename().string() : below;
    return std::ranges::any_of(owners.cameras, [&](const std::string& camera) {
        return likeness(known_name(camera, owners.names), label, {}) >= kByWords;
    });
}

bool has_word_for_camera(const Shots& room) {
    return std::ranges::any_of(tokens(last_part(room.label)), [](const std::string& word) {
        return word == "cam" || word == "camera" || word == "kamera";
    });
}

// Pictures with the names of the frames, as 01.jpg beside 01.mp4. Empty if one has another number:
// then they are a sequence.
Rooms by_names_of_frames(const Material& material, const std::vector<Shots>& pictures) {
    std::map<std::string, std::string> camera_of;
    for (const auto& [camera, frames] : material.frames)
        camera_of.emplace(lower(last_part(frames.label)), camera);
    if (camera_of.size() < material.frames.size()) return {};
    Rooms rooms;
    for (const Shots& picture : pictures) {
        const std::string name = lower(last_part(picture.label));
        if (const auto found = camera_of.find(name); found != camera_of.end()) {
            rooms[found->second] = picture;
        } else if (std::ranges::none_of(name, is_letter)) {
            return {};
        }
    }
    return rooms.size() < 2 ? Rooms() : rooms;
}

bool have_sizes_of_frames(const Material& material, const Rooms& rooms) {
    return std::ranges::all_of(rooms, [&](const auto& entry) {
        const auto look = look_at(entry.second);
        // an unreadable one is reported where its size is checked
        return !look || size_of(*look) == size_of(material.looks.at(entry.first));
    });
}

// Pictures with the names or numbers of these cameras.
Rooms by_cameras(const Material& material,
                 const std::vector<Shots>& pictures,
                 const RoomOwners& owners) {
    std::vector<Shots> named = pictures;
    for (Shots& picture : named) {
        picture.label = last_part(picture.label);
        picture.is_alone = false;  // so that its number counts
    }
    auto matches = match_shots(owners.cameras, named, owners.names);
    if (!matches || matches->by_camera.size() < pictures.size()) return {};
    const bool are_of_all = matches->missing.empty();
    Rooms rooms;
    for (auto& [camera, room] : matches->by_camera) {
        if (!material.frames.contains(camera)) continue;
        const auto picture = std::ranges::find(
            pictures, room.pictures.at(0), [](const Shots& one) -> const auto& {
                return one.pictures.at(0);
            });
        rooms[camera] = *picture;
    }
    if (std::ranges::all_of(pictures, has_word_for_camera)) return rooms;
    return are_of_all && have_sizes_of_frames(material, rooms) ? rooms : Rooms();
}

Rooms pair_folder(const Material& material,
                  const std::vector<Shots>& pictures,
                  const RoomOwners& owners) {
    if (pictures.size() < 2 || has_camera_in_path(pictures.front(), owners)) return {};
    if (Rooms rooms = by_names_of_frames(material, pictures); !rooms.empty()) return rooms;
    RoomOwners with_frames{{}, owners.names};
    for (const auto& [camera, frames] : material.frames) with_frames.cameras.push_back(camera);
    if (Rooms rooms = by_cameras(material, pictures, with_frames); !rooms.empty()) return rooms;
    return by_cameras(material, pictures, owners);
}

// The first few, and how many there are.
std::string some_of(const std::vector<std::string>& unsorted) {
    constexpr std::size_t kMost = 4;
    const std::vector<std::string> names = in_natural_order(unsorted);
    std::string text;
    for (std::size_t i = 0; i < names.size() && i < kMost; ++i)
        text += fmt::format("{}'{}'", i == 0 ? "" : ", ", names[i]);
    return names.size() > kMost ? fmt::format("{}, ... ({} in all)", text, names.size()) : text;
}

}  // namespace

Expected<Rooms> pair_single_rooms(const Material& material,
                                  const std::vector<Shots>& rooms,
                                  const RoomOwners& owners) {
    std::map<fs::path, std::vector<Shots>> folders;
    for (const Shots& room : rooms)
        if (room.is_alone) folders[room.path].push_back(room);
    Rooms best;
    std::vector<std::string> names;  // of the folders that are as good
    for (const auto& [folder, pictures] : folders) {
        Rooms paired = pair_folder(material, pictures, owners);
        if (paired.empty() || paired.size() < best.size()) continue;
        if (paired.size() > best.size()) names.clear();
        names.push_back(folder.string());
        best = std::move(paired);
    }
    if (names.size() < 2) return best;
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("{} and {} each hold a picture of the empty room per camera; "
                                  "name one of them with --background",
                                  names[0],
                                  names[1]));
}

bool may_be_one_per_camera(const Material& material, const Shots& room, const RoomOwners& owners) {
    if (room.is_video || room.is_alone || room.num_pictures() != material.frames.size() ||
        has_camera_in_path(room, owners))
        return false;
    std::multiset<Size> of_frames;
    std::multiset<Size> of_room;
    for (const auto& [camera, look] : material.looks)
        if (material.frames.contains(camera)) of_frames.insert(size_of(look));
    for (const auto& [number, file] : room.pictures) {
        const auto look = look_at({file.parent_path(), false, {{0, file}}, {}});
        if (!look) return false;
        of_room.insert(size_of(*look));
    }
    return of_frames == of_room;
}

std::string why_no_room_fits(const std::string& where,
                             const Material& material,
                             const std::vector<Shots>& rooms,
                             const RoomOwners& owners) {
    std::set<std::string> found;
    std::set<fs::path> folders;  // whose pictures are named one by one
    for (const Shots& room : rooms) {
        if (room.is_alone) folders.insert(room.path);
        if (room.is_video || room.is_alone)
            found.insert(room.label +
                         (room.is_video ? room.path : room.pictures.at(0)).extension().string());
    }
    for (const Shots& room : rooms) {
        if (room.is_video || room.is_alone || folders.contains(room.path)) continue;
        found.insert((fs::path(room.label) / room.pictures.begin()->second.filename()).string());
    }
    std::vector<std::string> cameras;
    std::vector<std::string> labels;
    for (const auto& [camera, frames] : material.frames) {
        cameras.push_back(known_name(camera, owners.names));
        labels.push_back(last_part(frames.label));
    }
    if (found.empty()) return fmt::format(", and {} has neither videos nor pictures", where);
    return fmt::format(
        ", although {} has {} (wanted: a picture, video or folder per camera, with the camera's "
        "name, as {}{})",
        where,
        some_of({found.begin(), found.end()}),
        some_of(cameras),
        labels == cameras ? "" : ", or that of its pictures, as " + some_of(labels));
}

}  // namespace atrium::calibrate
