#pragma once

#include "site_node/segmentation/background_model.hpp"

#include <optional>

namespace atrium::segmentation {

/// Measures how sharp a camera is: the width of the sharpest tenth of the isolated straight steps
/// in its empty room, as their contrast over their steepest slope [px]. About 1 without any blur,
/// 1.4 with a good lens. nullopt for a mosaic, and for a room with too few steps.
std::optional<double> edge_width_px(const BackgroundStatistics& room);

}  // namespace atrium::segmentation
