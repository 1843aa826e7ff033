#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "site_node/coherence/tangency.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace atrium::calibrate {

struct RefineOptions {
    std::vector<std::size_t> cameras;  // that may move; empty: all
    bool has_free_focal = false;       // of these cameras
    int num_threads = 1;
};

/// How far silhouettes agree, robust.
struct Tangent_px {
    double used = 0.0;
    double held_out = 0.0;  // of instants that the adjustment did not use
};

struct Refined {
    std::vector<geometry::CalibratedCamera> cameras;  // in the frame and scale of the old rig
    Tangent_px before, after;
    std::size_t num_tangencies = 0;     // that were used
    std::vector<std::size_t> held_out;  // numbers of these sights
    /// Uncertainty of what the silhouettes show least, over all free cameras: of a turn [deg] and a
    /// motion [mm] together. Large if the person moved too little; at most 10 and 1000.
    double weakest_deg = 0.0, weakest_mm = 0.0;
};

/// Adjusts the poses of cameras until the epipolar tangents of all silhouettes coincide, from a rig
/// that may be off by 1 degree and 3 cm. Tangents are chosen again between the adjustments. Each
/// camera has one free dilation of its silhouettes. Every fifth sight is held out.
///
/// Silhouettes do not show the frame and the scale of all cameras together: if all are free, the
/// result is laid on the old rig by the similarity under which most cameras stay where they were.
///
/// Error kInvalidData without tangencies of some camera.
Expected<Refined> refine(std::span<const geometry::CalibratedCamera> cameras,
                         std::span<const coherence::Sight> sights,
                         const RefineOptions& options);

/// The similarity under which most of `cameras` are where they are in `like`: moves and scales all
/// of them. Robust against some that moved.
std::vector<geometry::CalibratedCamera> laid_on(std::vector<geometry::CalibratedCamera> cameras,
                                                std::span<const geometry::CalibratedCamera> like);

}  // namespace atrium::calibrate
