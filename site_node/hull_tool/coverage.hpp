#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::hull_tool {

/// How a hull's projection compares with one silhouette, counted at the centres of the picture's
/// (undistorted) pixels.
struct Coverage {
    std::size_t silhouette_px = 0;
    std::size_t covered_px = 0;  // of these, projected onto by the hull
    std::size_t excess_px = 0;   // projected onto by the hull, but outside the silhouette

    double share() const {
        return static_cast<double>(covered_px) / static_cast<double>(silhouette_px);
    }
};

/// Reused memory: one byte per pixel each.
struct CoverageScratch {
    std::vector<std::uint8_t> silhouette;
    std::vector<std::uint8_t> near_silhouette;
    std::vector<std::uint8_t> hull;
    std::vector<std::uint8_t> field;
};

/// A pixel whose centre is nearer than 1e-3 px to an outline counts in the hull's favour: there the
/// two only differ by the hull's jitter and by rounding. Triangles are cut at the camera; any mesh
/// will do. Of a view with a field only pixels inside of it count.
Coverage measure_coverage(const geometry::TriangleMesh& mesh,
                          const hull::SilhouetteView& view,
                          CoverageScratch& scratch);

}  // namespace atrium::hull_tool
