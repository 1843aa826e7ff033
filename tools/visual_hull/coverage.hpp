#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::hull_tool {

/// Compares the projection of a hull with one silhouette, at the centres of the (undistorted)
/// pixels.
struct Coverage {
    std::size_t silhouette_px = 0;
    std::size_t covered_px = 0;  // of these, covered by the projected hull
    std::size_t excess_px = 0;   // covered by the projected hull, but outside the silhouette

    double share() const {
        return static_cast<double>(covered_px) / static_cast<double>(silhouette_px);
    }
};

/// Reusable memory: one byte per pixel each.
struct CoverageScratch {
    std::vector<std::uint8_t> silhouette;
    std::vector<std::uint8_t> near_silhouette;
    std::vector<std::uint8_t> hull;
    std::vector<std::uint8_t> field;
};

/// Measures the coverage. A pixel whose centre is within 1e-3 px of an outline counts in favour of
/// the hull: there only jitter and rounding differ. Triangles are clipped at the camera; any mesh
/// is valid. For a view with a field, only pixels inside the field count.
Coverage measure_coverage(const geometry::TriangleMesh& mesh,
                          const hull::SilhouetteView& view,
                          CoverageScratch& scratch);

}  // namespace atrium::hull_tool
