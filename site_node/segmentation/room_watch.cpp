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
    // of a camera that was moved a little, `look_at_view` tells more
    const bool is_told =
        num_other_light_ == kOtherLight && !find_view_shift(luma, picture.y, view_scratch_);
    return is_told ? doubt : std::nullopt;
}

bool RoomWatch::is_view_due() {
    if (--next_view_ > 0) return false;
    next_view_ = kViewGap;
    return true;
}

void RoomWatch::look_at_view(const image::YuvView& picture,
                             std::span<const std::uint16_t> room_luma) {
    constexpr double kSame_px = 3.0;
    const auto shift = find_view_shift(room_luma, picture.y, view_scratch_);
    const bool is_alike = shift.has_value() == last_shift_.has_value() &&
                          (!shift || (*shift - *last_shift_).norm() < kSame_px);
    num_alike_ = is_alike ? num_alike_ + 1 : 1;
    last_shift_ = shift;
    if (num_alike_ >= kSureViews) view_shift_ = shift;
}

}  // namespace atrium::segmentation
