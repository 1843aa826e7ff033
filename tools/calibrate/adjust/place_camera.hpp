#pragma once

#include "tools/calibrate/adjust/bundle.hpp"
#include "tools/calibrate/adjust/place_wands.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace atrium::calibrate {

/// Focal lengths that are tried where only a nominal one is known, as shares of it.
inline constexpr std::array<double, 5> kFocalScales{1.0, 0.8, 1.25, 0.65, 1.5};

/// Sightings that two cameras need in common; a camera needs half as many of known lights.
inline constexpr std::size_t kMinShared = 40;

/// Errors of a coarse place, in pictures' widths.
inline constexpr double kCoarse = 0.012;

/// Places a camera from its sightings of lights of placed wands at `instants`, with RANSAC, and
/// scales its focal length. Returns false, and leaves the lens as it is, if less than half of the
/// sightings agree.
bool place_camera(Bundle& bundle,
                  std::size_t index,
                  std::span<const InstantRange> ranges,
                  std::span<const std::uint32_t> instants);

}  // namespace atrium::calibrate
