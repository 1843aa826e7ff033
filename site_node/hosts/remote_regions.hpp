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
    /// Hands over the contours of the cameras with `delivered[camera] != 0`. Waits for no host.
    virtual void order(const bus::FrameKey& frame,
                       std::span<const hull::SilhouetteView> views,
                       std::span<const std::uint8_t> delivered) = 0;
    /// Waits for the answers to the last order, but not for hosts that are missing or too late:
    /// their regions are answered as failed.
    virtual std::vector<bus::RegionMeshes> collect() = 0;
};

}  // namespace atrium::hosts
