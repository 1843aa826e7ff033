#pragma once

#include "core/geometry/aabb.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/views/named_view.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

/// Checks the cameras of a site against each other: geometry alone, and silhouettes of people. Pure
/// functions without threads, for sites and tools.
namespace atrium::rig_check {

struct AgreementOptions {
    std::size_t rays_per_camera = 80;
    /// False: what lies outside a picture is unknown (partial views, regions).
    bool knows_outside = true;
    /// Cameras that must see a point beside the ray's own, if `knows_outside` is false.
    std::size_t min_seen = 1;
    /// Where people can be, site frame [m]. Rays that miss it do not count.
    std::optional<geometry::Aabb> bounds;
    /// The empty room was learned from pictures with people in it: who never left is part of it.
    bool is_room_learned = false;
};

/// How far one camera agrees with the others. Each ray passes through one pixel of its silhouette;
/// the rays are spread evenly over the silhouette.
struct CameraAgreement {
    std::size_t rays = 0;       // 0: this camera sees nobody
    std::size_t explained = 0;  // of these: have a point that no other camera contradicts
    std::size_t cut = 0;        // of these: such a point exists only just outside the bounds
    std::size_t beyond = 0;     // of these: most cameras agree, the pictures of the rest end before
    std::size_t contradicted = 0;  // others' rays that only this and few cameras contradict, where
                                   // the point is in this camera's picture
    std::size_t out_of_view = 0;   // the same, where the point is outside this camera's picture

    /// Share of the rays that speak for or against the rig. Bounds and the borders of pictures cut
    /// people without saying anything about it.
    double share() const {
        const std::size_t counted = rays - cut - beyond;
        return counted == 0 ? 1.0 : static_cast<double>(explained) / static_cast<double>(counted);
    }
};

struct Agreement {
    std::vector<CameraAgreement> cameras;  // in the order of the views
    /// [m] Per face of the bounds (-x, +x, -y, +y, -z, +z): how many rays it cuts, and the farthest
    /// coordinate of their points.
    std::array<std::size_t, 6> cut_by_face{};
    std::array<double, 6> farthest_cut_m{};

    std::size_t num_rays() const;
    /// Share of all rays that speak for or against the rig that are explained; 1 without any.
    double share() const;
    /// Share of all rays that are explained; 1 without rays.
    double strict_share() const;
    /// Index of the camera with the smallest share; 0 without rays.
    std::size_t worst() const;
};

/// Measures how much of each silhouette the silhouettes of all other cameras explain. That is the
/// share of the silhouette that the visual hull covers, measured without computing the hull, so it
/// also has an answer where the hull has none. Cameras without contours abstain.
///
/// Deterministic, independent of the unit of length. 8 views of 250 points take about 2 ms.
Agreement measure_agreement(std::span<const hull::SilhouetteView> views,
                            const AgreementOptions& options);
Agreement measure_agreement(std::span<const views::NamedView> views,
                            const AgreementOptions& options);

}  // namespace atrium::rig_check
