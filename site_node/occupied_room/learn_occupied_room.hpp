#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

namespace atrium::occupied_room {

/// Pictures of a room with people in it, taken by all cameras at the same instants, which should
/// spread over minutes.
struct OccupiedRoom {
    std::span<const geometry::CalibratedCamera> cameras;
    geometry::Aabb bounds_site;  // where people can be
    /// [camera][instant]; a view without pixels: no picture. The memory must outlive the call.
    std::vector<std::vector<image::YuvView>> pictures;
};

/// What one camera learned.
struct LearnedRoom {
    segmentation::BackgroundStatistics room;
    /// Share of the pixels that never showed the empty room. They have the look of their
    /// surroundings, therefore people there stay foreground.
    double never_empty = 0.0;
    /// Where most of these pixels are: bounds of the largest connected part. Empty without any.
    image::PixelRect never_empty_px;
    /// Share of the pixels of a picture that people cover, on average.
    double covered = 0.0;
};

/// Fewest pictures of one camera to learn from.
constexpr std::size_t kMinOccupiedPictures = 8;

/// Learns the empty room from pictures with people in it. Each 2x2 block of pixels shows several
/// looks over time, one of them the room. First takes the most frequent look. Then segments all
/// pictures with this room and corrects it, repeatedly:
///
/// - An outline whose edge lies in the learned room instead of the picture (outline_votes.hpp)
///   shows that somebody stood there most of the time and is part of the learned room: there the
///   look within this outline is the room's.
/// - Where the other cameras agree that a person hides a block, its look does not count.
/// - A block that shows no lasting look, and what such blocks enclose, was never seen empty.
///
/// Results are in the order of the cameras; error kNotFound for a camera with too few pictures.
/// Calls `progress(steps done, steps in total)`; a step is a pass over the pictures of a camera.
/// Ends early with kUnavailable on a stop. Needs a few bytes per pixel, camera and instant.
std::vector<Expected<LearnedRoom>> learn_occupied_room(
    const OccupiedRoom& seen,
    const segmentation::SegmentationOptions& options,
    const std::function<void(std::size_t, std::size_t)>& progress,
    std::stop_token stop);

}  // namespace atrium::occupied_room
