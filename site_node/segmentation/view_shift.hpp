#pragma once

#include "core/image/image.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace atrium::segmentation {

/// A picture of a half or a quarter of the width and height, for find_view_shift.
struct SmallPicture {
    int width = 0;
    int height = 0;
    std::vector<float> luma;  // row by row, 0 to 255
};

/// Memory for find_view_shift.
struct ViewScratch {
    struct Square {
        int x = 0;  // top left corner in a quarter of the picture
        int y = 0;
        float variance = 0.0f;  // of the room
    };
    SmallPicture half_room, half_picture, quarter_room, quarter_picture;
    std::vector<Square> squares;
    std::vector<double> likeness;  // at each shift
};

inline constexpr double kLeastShift_px = 2.3;

/// Compares a picture with the empty room that was learned, by squares with texture spread over the
/// room. Returns by how much the picture shows the room shifted [px], x to the right, y downwards:
/// the camera was moved since. nullopt if they fit within kLeastShift_px, if no shift explains most
/// squares (many people, a shift of more than 70 px), for a room with little texture, or one of
/// another size. Light does not matter.
///
/// `room_luma`: means per pixel [1/256], row by row, as in BackgroundStatistics. People hide some
/// squares, but shift none together; still, ask several pictures. Compares few places, and many
/// only if the view has changed. Allocates only while `scratch` grows.
std::optional<Eigen::Vector2d> find_view_shift(std::span<const std::uint16_t> room_luma,
                                               const image::PlaneView& picture_luma,
                                               ViewScratch& scratch);

}  // namespace atrium::segmentation
