#pragma once

#include "site_node/capture/metaframe.hpp"
#include "site_node/preview/preview_picture.hpp"
#include "tools/calibrate/sweep/resting_wand.hpp"
#include "tools/calibrate/sweep/sweep_tally.hpp"

#include <vector>

namespace atrium::calibrate {

/// What a preview of a sweep shows of one instant: each picture, brightened, with the lights
/// that move encircled, the covered fields tinted, and what the camera still needs.
std::vector<preview::View> views_of(const capture::Metaframe& instant, const SweepTally& tally);

/// Likewise while the wand lies on the floor: its lights encircled, and who sees it.
std::vector<preview::View> views_of(const capture::Metaframe& instant,
                                    const RestingWand& resting,
                                    const std::vector<NominalCamera>& cameras);

}  // namespace atrium::calibrate
