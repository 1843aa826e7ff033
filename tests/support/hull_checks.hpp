#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

// What tests ask of hulls again and again.
namespace atrium::test {

/// With phantoms and fragments.
inline hull::VisualHull exact_hull_of(const std::vector<hull::SilhouetteView>& views) {
    hull::HullOptions options;
    options.keep_phantoms = true;
    hull::HullScratch scratch;
    return compute_visual_hull(views, options, scratch);
}

/// A closed 2-manifold, and as many components as are said.
inline void expect_closed(const hull::VisualHull& hull) {
    ASSERT_EQ(hull.status, hull::HullStatus::kOk) << to_string(hull.status);
    const geometry::MeshReport report = geometry::inspect(hull.mesh);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.manifold);
    EXPECT_GT(report.volume_m3, 0.0);
    EXPECT_EQ(report.num_components, hull.num_components);
    // no vertex was added to triangulate
    EXPECT_EQ(
        static_cast<std::int64_t>(hull.mesh.triangles.size()),
        2 * static_cast<std::int64_t>(hull.mesh.vertices.size()) - 2 * report.euler_characteristic);
}

/// General position as well: three faces in every vertex.
inline void expect_sound(const hull::VisualHull& hull) {
    expect_closed(hull);
    EXPECT_EQ(hull.mesh.vertices.size() % 2, 0u);
}

}  // namespace atrium::test
