#pragma once

#include "tools/calibrate/recording/gather.hpp"

#include <map>
#include <string>
#include <vector>

/// Folders with one picture of the empty room per camera.
namespace atrium::calibrate {

/// The cameras of a rig in pictures of the empty room.
struct RoomOwners {
    std::vector<std::string> cameras;  // also those without frames: their rooms may be there
    Originals names;                   // of the cameras, in the pictures
};

/// The empty rooms of the cameras that have frames, out of the folder in which each picture is that
/// of another camera: its name is that of the camera's frames, or its number that of the camera. If
/// only numbers tell, and no word for a camera stands before them, the folder must have a picture
/// of the right size for each camera and none beside. A folder with a camera's name in its path is
/// that camera's alone. Empty if no folder is so; error kConfiguration, with the folders, if two
/// are. `rooms` are as `find_shots` returns them; only single pictures count.
Expected<std::map<std::string, Shots>> pair_single_rooms(const Material& material,
                                                         const std::vector<Shots>& rooms,
                                                         const RoomOwners& owners);

/// Whether a folder of pictures that has only a number in common with a camera may hold one picture
/// of each camera instead: it has as many pictures as there are cameras, of their sizes, and no
/// camera's name in its path.
bool may_be_one_per_camera(const Material& material, const Shots& room, const RoomOwners& owners);

/// Continues "no empty room of ..." with the names that lie below the folder `where` and with those
/// that were looked for. For the case that none fits.
std::string why_no_room_fits(const std::string& where,
                             const Material& material,
                             const std::vector<Shots>& rooms,
                             const RoomOwners& owners);

}  // namespace atrium::calibrate
