#pragma once

#include "tools/calibrate/adjust/bundle.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace atrium::calibrate {

/// The sightings of one instant: [begin, end) in Bundle::sightings.
struct InstantRange {
    std::size_t begin = 0, end = 0;
};

/// One range per instant; empty where nothing was seen.
std::vector<InstantRange> ranges_of(const Bundle& bundle);

/// The point nearest to the rays of a light from several placed cameras [m]. Empty if fewer than
/// two cameras see it, or all from about one direction.
std::optional<Eigen::Vector3d> triangulate(const Bundle& bundle,
                                           std::span<const Sighting* const> sightings);

/// The pose of the wand whose lights lie nearest to `lights_world` (per light; empty: not known).
/// Empty if too few are known: 1 for a point, 2 for a line, 3 for a body.
std::optional<geometry::RigidTransform> fit_wand(
    const Wand& wand, std::span<const std::optional<Eigen::Vector3d>> lights_world);

/// Places the wand at each instant in `instants` from its sightings in placed cameras, without
/// trust in any of them: of the pairs of cameras, the wand that most sightings agree with within
/// `most_px`. Marks these sightings as used and the others of these instants as not. An instant
/// whose wand fewer than two cameras agree on stays without place.
void place_wands(Bundle& bundle,
                 std::span<const InstantRange> ranges,
                 std::span<const std::uint32_t> instants,
                 double most_px);

}  // namespace atrium::calibrate
