#pragma once

#include "core/geometry/aabb.hpp"

#include <optional>
#include <string>

namespace atrium::rig_check {

/// Says what is implausible about the size of a hull of people, with cause and cure; nullopt for a
/// plausible or empty hull. `extent`: box around the hull. `coverage`: share of the silhouettes
/// that the hull explains. A hull of a whole scene with people at the cameras' limits may be some
/// metres large.
std::optional<std::string> check_size(const geometry::Aabb& extent,
                                      double volume_m3,
                                      double coverage);

}  // namespace atrium::rig_check
