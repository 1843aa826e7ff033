#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "site_node/rig_check/rig_geometry.hpp"

#include <optional>
#include <span>

namespace atrium::rig_check {

/// Doubts the `[bounds]` of a rig [m] that are at least 15 times as large as the distance between
/// its cameras, or hardly a fiftieth of it: they are in another unit than the rig, and cut nothing
/// or all. `unit_m` is the unit of the file (config::Rig).
std::optional<Finding> check_bounds(const geometry::Aabb& bounds_site,
                                    std::span<const geometry::CalibratedCamera> cameras,
                                    double unit_m);

/// Doubts a region of the room [m] that is outside of the `[bounds]` of the rig, in which no point
/// is in the pictures of two cameras, or that is farther beyond the cameras than half of their
/// distance.
std::optional<Finding> check_region(const geometry::Aabb& bounds_site,
                                    std::span<const geometry::CalibratedCamera> cameras,
                                    const std::optional<geometry::Aabb>& room_site = {});

}  // namespace atrium::rig_check
