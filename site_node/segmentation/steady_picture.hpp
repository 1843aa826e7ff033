#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

#include <optional>
#include <span>

namespace atrium::segmentation {

/// What most pictures of a fixed camera agree on, pixel by pixel.
struct SteadyPicture {
    image::YuvImage picture;  // medians, or means where all pictures are alike
    image::Mask is_steady;    // 255 where at least 60 % of the pictures show about the median
};

/// `pictures` must not be empty, and must have one even size and no mosaic.
SteadyPicture find_steady_picture(std::span<const image::YuvImage> pictures);

/// Centre of a ghost [px].
struct RoomGhost {
    int x = 0;
    int y = 0;
};

/// Looks for a person, or a thing that has gone since, in pictures of the empty room: a part that
/// differs from what a take shows most of the time, and whose outline has its edge in the room
/// instead of the take (outline_votes.hpp). Returns the largest one, or the centre of its pieces.
/// Somebody who stands still in the take has the edge there and is no ghost. Shadows and gradual
/// changes of the light, in either direction, are none.
///
/// Finds nothing if more than half of the picture differs: the view or the light is another one.
/// `room` and `take` must have one size.
std::optional<RoomGhost> find_ghost(const BackgroundStatistics& room,
                                    const SteadyPicture& take,
                                    const SegmentationOptions& options);

}  // namespace atrium::segmentation
