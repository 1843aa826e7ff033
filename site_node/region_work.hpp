#pragma once

#include "core/base/executor.hpp"
#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "site_node/hull_stage.hpp"
#include "site_node/mesh_coding.hpp"

#include <string>
#include <vector>

namespace atrium::site_node {

/// Turns an order into the coded meshes of the regions of one host, with the hull stage and the
/// mesh coding of the pipeline: the same bytes as in a site of one process. Uses no network.
class RegionWork {
public:
    /// `hull` computes the regions of this host; all others are elsewhere. `settings` as in
    /// bus::RegionOrder.
    RegionWork(std::vector<geometry::CalibratedCamera> cameras,
               HullStage hull,
               const codec::MeshCodecOptions& options,
               std::uint64_t settings);

    std::size_t num_regions() const { return regions_.size(); }

    /// Fills all but site, host and frame. Regions without a hull are marked as failed, and all of
    /// them as of another rig if the order has other settings. Error kInvalidData if it has cameras
    /// that the rig lacks.
    Expected<void> compute(const bus::RegionOrder& order,
                           Executor& executor,
                           bus::RegionMeshes& answer);

    /// Makes it an answer without any mesh.
    void fail(const Error& error, bus::RegionMeshes& answer) const;

private:
    Expected<void> take(const bus::RegionOrder& order);
    void fail(bus::RegionOutcome outcome, std::string reason, bus::RegionMeshes& answer) const;

    std::vector<geometry::CalibratedCamera> cameras_;
    HullStage hull_;
    std::vector<std::uint32_t> regions_;  // of this host
    MeshCoding meshes_;                   // one of each region of the site
    std::uint64_t settings_;
    std::vector<std::uint8_t> delivered_;
    hull::VisualHull whole_;
};

}  // namespace atrium::site_node
