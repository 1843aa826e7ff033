#include "site_node/segmentation/outline_votes.hpp"

namespace atrium::segmentation {

OutlineVote compare_contrasts(int in_picture, int in_room) {
    // a vote needs a clear difference: noise, shadows and textures give small ones
    constexpr int kMargin = 12;
    if (2 * in_picture > 3 * in_room + 2 * kMargin) return OutlineVote::kPicture;
    if (2 * in_room > 3 * in_picture + 2 * kMargin) return OutlineVote::kRoom;
    return OutlineVote::kUndecided;
}

int contrast(const image::YuvView& picture, int x0, int y0, int x1, int y1) {
    return std::abs(picture.y.at(x0, y0) - picture.y.at(x1, y1)) +
           std::abs(picture.u.at(x0 / 2, y0 / 2) - picture.u.at(x1 / 2, y1 / 2)) +
           std::abs(picture.v.at(x0 / 2, y0 / 2) - picture.v.at(x1 / 2, y1 / 2));
}

int contrast(const BackgroundStatistics& room, int x0, int y0, int x1, int y1) {
    const auto at = [](int x, int y, int width) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    };
    const std::size_t pixel0 = at(x0, y0, room.width);
    const std::size_t pixel1 = at(x1, y1, room.width);
    const std::size_t block0 = at(x0 / 2, y0 / 2, room.width / 2);
    const std::size_t block1 = at(x1 / 2, y1 / 2, room.width / 2);
    return std::abs(room.luma[pixel0] - room.luma[pixel1]) / 256 +
           (std::abs(room.u[block0] - room.u[block1]) + std::abs(room.v[block0] - room.v[block1])) /
               128;
}

}  // namespace atrium::segmentation
