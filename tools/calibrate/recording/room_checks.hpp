#pragma once

#include "tools/calibrate/recording/gather.hpp"

#include <string>
#include <vector>

namespace atrium::calibrate {

/// People in pictures of the empty room, another light or view, or nobody to be seen before it.
struct RoomDoubt {
    std::string text;  // the cameras, places, files and the cure
    bool is_in_most_cameras = false;
};

/// Compares the pictures of the empty room with what the take shows most of the time
/// (segmentation/steady_picture.hpp, room_light.hpp), from up to 24 pictures per camera. Of long
/// videos it reads a part in the middle, because every picture of it has to be decoded. Passes over
/// cameras without an empty room, with fewer than 8 pictures or with unreadable ones. With masks a
/// site uses no empty room, so nothing is compared.
std::vector<RoomDoubt> doubt_rooms(const Material& material);

}  // namespace atrium::calibrate
