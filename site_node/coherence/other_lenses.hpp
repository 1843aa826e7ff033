#pragma once

#include "site_node/coherence/tangency.hpp"

#include <optional>
#include <span>

namespace atrium::coherence {

/// The lenses of all cameras, against those of the rig.
struct OtherLenses {
    double factor = 1.0;     // of all focal lengths
    double before_px = 0.0;  // robust errors of the tangents, with the rig's lenses
    double after_px = 0.0;   // with the factor
};

/// Errors below this are not worth a search for their cause [px].
inline constexpr double kDoubtful_px = 0.8;
/// A factor is other than 1 from here on: calibrations of the same lenses differ by less.
inline constexpr double kOtherFactor = 0.015;

/// Tries whether one factor of all focal lengths explains the errors of a rig, as if pictures were
/// filmed with another zoom, crop or stabilisation than those of its calibration: from 0.7 to 1.4,
/// with the poses as they are. nullopt if the errors are small, or if no factor lowers them
/// clearly, in most parts of the window and for most pairs of cameras, three at least.
///
/// Searches tangents again for each factor it tries: some tenths of a second for 48 sights of eight
/// cameras.
std::optional<OtherLenses> find_other_lenses(std::span<const geometry::CalibratedCamera> cameras,
                                             std::span<const Sight> sights);

}  // namespace atrium::coherence
