#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/component_votes.hpp"
#include "site_node/segmentation/room_light.hpp"
#include "site_node/segmentation/view_shift.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::segmentation {

/// Watches whether the learned room contains a person: somebody who stood there while it was
/// learned leaves a ghost, foreground that stays at its place and whose outline has its edge in the
/// learned room instead of the picture. Somebody who never leaves goes unnoticed. Also watches
/// whether the room has the light and the view of the pictures, and by how much that is shifted.
///
/// Looks at few pictures, some at the start and then rarely: it costs about as much as segmenting a
/// picture. Not thread-safe.
class RoomWatch {
public:
    struct Ghost {
        int x = 0;  // centre [px]
        int y = 0;
    };

    /// `delay` puts off the first look, so that cameras look at different instants.
    explicit RoomWatch(std::uint32_t delay = 0)
        : next_(kFirstGap + delay), next_view_(kFirstGap + delay) {}

    /// Counts a picture; true if it should be shown to `look`.
    bool is_due();

    /// Looks at a segmented picture. Returns a ghost as soon as it is sure of one, once.
    std::optional<Ghost> look(const image::YuvView& picture,
                              const BackgroundStatistics& room,
                              const image::Mask& mask);

    /// Returns what is wrong with the light or view of the room (room_light.hpp) once kOtherLight
    /// looks in a row have said so; once. `luma`: the model's current means [1/256].
    std::optional<std::string> look_at_light(const image::YuvView& picture,
                                             std::span<const std::uint16_t> luma);

    /// Counts a picture; true if it should be shown to `look_at_view`.
    bool is_view_due();
    /// Compares where the picture and the learned room show the same (view_shift.hpp).
    /// `room_luma`: the means that were learned [1/256].
    void look_at_view(const image::YuvView& picture, std::span<const std::uint16_t> room_luma);
    /// By how much the picture shows the room shifted [px], once kSureViews looks in a row agree,
    /// until as many find no shift.
    const std::optional<Eigen::Vector2d>& view_shift() const { return view_shift_; }
    static constexpr std::uint32_t kViewGap = 90;
    static constexpr int kSureViews = 2;

    /// Pictures between the first looks, and between later ones.
    static constexpr std::uint32_t kFirstGap = 24;
    static constexpr std::uint32_t kLaterGap = 900;
    static constexpr int kFirstLooks = 10;
    /// Looks with a ghost at one place to be sure, of the last kFirstLooks.
    static constexpr int kSure = 6;
    static constexpr int kOtherLight = 3;

private:
    // The picture is divided into kGrid x kGrid places. Bit i: a ghost i looks ago.
    static constexpr int kGrid = 12;

    std::uint32_t num_pictures_ = 0;
    std::uint32_t next_;
    int num_looks_ = 0;
    bool is_done_ = false;
    int num_other_light_ = 0;  // looks in a row; not counted on once told
    std::array<std::uint16_t, kGrid * kGrid> history_{};
    ComponentScratch scratch_;
    LightScratch light_scratch_;

    std::uint32_t next_view_;  // pictures until then
    std::optional<Eigen::Vector2d> last_shift_, view_shift_;
    int num_alike_ = 0;  // looks in a row that agree with `last_shift_`
    ViewScratch view_scratch_;
};

}  // namespace atrium::segmentation
