#pragma once

#include "core/bus/messages.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hosts {

/// Hosts that compute the hulls of regions.
class RemoteRegions {
public:
    virtual ~RemoteRegions() = default;
    /// Hands over the contours of the cameras with `delivered[camera] != 0`. Does not wait.
    virtual void order(std::uint64_t frame_id,
                       std::span<const hull::SilhouetteView> views,
                       std::span<const std::uint8_t> delivered) = 0;
    /// Waits for the answers to that order, but not for hosts that are missing or too late: their
    /// regions are answered as failed.
    virtual std::vector<bus::RegionMeshes> collect(std::uint64_t frame_id) = 0;
};

}  // namespace atrium::hosts
