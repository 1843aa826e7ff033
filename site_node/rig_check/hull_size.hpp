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

/// Whether a hull is too small for a person of any pose, even a child that crouches. False if
/// empty.
bool is_small_for_person(const geometry::Aabb& extent, double volume_m3);

/// Says what may be wrong with a rig if `height_m`, the median height of the people at many
/// instants, is more than that of anybody, even with raised arms; nullopt if it is not.
std::optional<std::string> doubt_tall_people(double height_m);

/// Says what may be wrong with a rig if `height_m`, that of the people who stand, is less than that
/// of adults; nullopt if it is not. Children, and people who always sit, are as small.
std::optional<std::string> doubt_small_people(double height_m);

/// Says what may be wrong with a rig whose hulls stay too small for a person, with the cure.
std::string doubt_small_hull(const geometry::Aabb& extent, double volume_m3);

}  // namespace atrium::rig_check
