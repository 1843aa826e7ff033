#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

// Common checks of hulls.
namespace atrium::test {

/// Keeps phantoms and fragments.
inline hull::VisualHull exact_hull_of(const std::vector<hull::SilhouetteView>& views) {
    hull::HullOptions options;
    options.keep_phantoms = true;
    hull::HullScratch scratch;
    return compute_visual_hull(views, options, scratch);
}

/// Expects a closed 2-manifold with the reported number of components.
inline void expect_closed(const hull::VisualHull& hull) {
    ASSERT_EQ(hull.status, hull::HullStatus::kOk) << to_string(hull.status);
    const geometry::MeshReport report = geometry::inspect(hull.mesh);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.manifold);
    EXPECT_GT(report.volume_m3, 0.0);
    EXPECT_EQ(report.num_components, hull.num_components);
    // the triangulation added no vertex
    EXPECT_EQ(
        static_cast<std::int64_t>(hull.mesh.triangles.size()),
        2 * static_cast<std::int64_t>(hull.mesh.vertices.size()) - 2 * report.euler_characteristic);
}

/// Expects general position as well: three faces at every vertex.
inline void expect_sound(const hull::VisualHull& hull) {
    expect_closed(hull);
    EXPECT_EQ(hull.mesh.vertices.size() % 2, 0u);
}

}  // namespace atrium::test
