#include "site_node/segmentation/room_watch.hpp"

#include <algorithm>
#include <bit>

namespace atrium::segmentation {

bool RoomWatch::is_due() {
    if (is_done_ || ++num_pictures_ < next_) return false;
    num_pictures_ = 0;
    next_ = num_looks_ + 1 < kFirstLooks ? kFirstGap : kLaterGap;
    return true;
}

std::optional<RoomWatch::Ghost> RoomWatch::look(const image::YuvView& picture,
                                                const BackgroundStatistics& room,
                                                const image::Mask& mask) {
    ++num_looks_;
    count_votes(picture, room, mask, scratch_);
    constexpr std::uint16_t kKept = (1 << kFirstLooks) - 1;
    for (std::uint16_t& looks : history_) looks = static_cast<std::uint16_t>(looks << 1 & kKept);
    std::optional<Ghost> sure;
    std::int32_t largest = 0;
    for (const ComponentVotes& component : scratch_.components) {
        if (!is_clear_ghost(component) || !has_size_of_person(component.size, mask)) continue;
        const Ghost at{static_cast<int>(component.sum_x / component.size),
                       static_cast<int>(component.sum_y / component.size)};
        std::uint16_t& looks = history_[static_cast<std::size_t>(
            at.y * kGrid / mask.height * kGrid + at.x * kGrid / mask.width)];
        looks |= 1;
        if (std::popcount(looks) < kSure || component.size <= largest) continue;
        largest = component.size;
        sure = at;
    }
    is_done_ = sure.has_value();
    return sure;
}

std::optional<std::string> RoomWatch::look_at_light(const image::YuvView& picture,
                                                    std::span<const std::uint16_t> luma) {
    if (num_other_light_ >= kOtherLight) return std::nullopt;
    auto doubt = doubt_of_light(luma, picture.y, light_scratch_);
    num_other_light_ = doubt ? num_other_light_ + 1 : 0;
    return num_other_light_ == kOtherLight ? doubt : std::nullopt;
}

}  // namespace atrium::segmentation
