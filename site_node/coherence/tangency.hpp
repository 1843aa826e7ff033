#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "site_node/coherence/silhouette_hull.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace atrium::coherence {

/// The silhouettes of all cameras of a rig at one instant, in the rig's order.
struct Sight {
    std::vector<SilhouetteHull> now;
    /// One instant before, for the motion of the outlines; empty: unknown.
    std::vector<SilhouetteHull> before;
};

/// One camera's part in a tangency.
struct TangentEnd {
    std::uint32_t camera = 0;
    Eigen::Vector3d ray_camera;  // unit vector to the tangent point, camera frame
    /// Derivatives of Tangency::error_px: by a small turn of the camera about its centre [px/rad]
    /// and by a motion of its centre [px/m], both site frame, and by a dilation of its silhouette
    /// [px/px].
    Eigen::Vector3d by_turn, by_move;
    double by_dilation = 0.0;
};

/// An outermost plane through the centres of two cameras that touches both silhouettes. It touches
/// the body in one point (a frontier point), so both pictures show the same plane if the rig is
/// true.
struct Tangency {
    std::uint32_t sight = 0;  // number of the instant
    std::array<TangentEnd, 2> ends;
    /// The angle between the tangent planes of both cameras about their baseline, as the distance
    /// of the outlines in the pictures; positive if the first camera's is ahead.
    double error_px = 0.0;
    double rad_per_px = 0.0;
    /// Change of the plane's angle since the instant before [px], the mean of both; NaN if unknown.
    double motion_px = 0.0;
};

struct TangencyOptions {
    /// Frontier points outside the silhouettes of most other cameras by more than this do not
    /// count: somebody, or a false silhouette, that not all cameras see.
    double confirmed_px = 20.0;
    /// Larger errors do not count.
    double most_px = 60.0;
};

/// The pairs of cameras that are compared: all of up to 17 cameras. Of more, each camera with 16
/// others, spread over the rig.
std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_of(std::size_t num_cameras);

/// Adds the tangencies of one instant to `out`: up to two per pair. Left out are tangents at the
/// border of a picture, pairs of which one camera sees the other in or near a silhouette (there is
/// no outermost plane), and frontier points that most other cameras contradict.
///
/// A silhouette is seen through its convex hull, which has the same outermost tangents. The angle
/// about the baseline is measured in half-planes, so epipoles may lie anywhere outside of the
/// silhouettes, behind the cameras and at infinity. The derivatives hold the tangent points fixed:
/// exact to first order, because an envelope's tangent point moves along the tangent.
///
/// Frontier points and tangency error: Hernandez, Schmitt, Cipolla, "Silhouette coherence for
/// camera calibration under circular motion" (PAMI 2007); Ben-Artzi, "Camera calibration by
/// global constraints on the motion of silhouettes" (ICCV 2017). We differ: no outline's interior
/// is used, errors are measured as angles between planes and divided by their sensitivity to a
/// pixel in both pictures, and each frontier point is confirmed by the other cameras.
void find_tangencies(std::span<const geometry::CalibratedCamera> cameras,
                     const Sight& sight,
                     std::uint32_t number,
                     const TangencyOptions& options,
                     std::vector<Tangency>& out);

}  // namespace atrium::coherence
