#pragma once

#include "core/config/rig.hpp"
#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::site_node {

/// How far the people agree that rooms, learned with people in them, show in the pictures from
/// which they were learned.
struct LearnedAgreement {
    std::size_t num_instants = 0;  // with somebody
    double explained = 0.0;        // share of the silhouettes that all others explain
    std::string worst;             // camera
    double worst_explained = 0.0;
};

/// Segments up to 12 instants with the learned rooms and compares the cameras, as the site does
/// later (rig_check/agreement.hpp). A person who never left a place is part of every room: of a
/// whole person nothing is left, but of one who turned on the spot arms and legs, which contradict
/// each other. What lies outside a picture is unknown.
///
/// `pictures`: [camera][instant], a view without pixels: no picture; `rooms`: null for a camera
/// without one. nullopt with fewer than three rooms, without an instant that all of them show, and
/// if nobody is seen.
std::optional<LearnedAgreement> compare_learned_rooms(
    const config::Rig& rig,
    std::span<const std::vector<image::YuvView>> pictures,
    std::span<const segmentation::BackgroundStatistics* const> rooms,
    const segmentation::SegmentationOptions& options,
    const std::stop_token& stop);

/// Says that people are probably part of the learned rooms, with the cure; empty if the cameras
/// agree.
std::string doubt_learned_rooms(const LearnedAgreement& agreement);

}  // namespace atrium::site_node
