#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <cstdint>

namespace atrium::test {

/// How a closed mesh differs from the true one. Distances are those of points spread evenly over
/// one surface to the other.
struct SolidError {
    double true_volume_l = 0.0;
    double volume_l = 0.0;
    double excess_l = 0.0;      // of the mesh, outside the true solid
    double missing_l = 0.0;     // of the true solid, outside the mesh
    double mean_mm = 0.0;       // from the mesh to the truth
    double p95_mm = 0.0;        // likewise: the 95th percentile
    double true_mean_mm = 0.0;  // from the truth to the mesh
    double true_p95_mm = 0.0;
};

struct SolidErrorOptions {
    double cell_m = 0.02;   // one point of each cell of this size decides volumes
    int num_points = 2000;  // on each surface
    std::uint64_t seed = 1;
};

/// Compares two closed meshes that face outwards. Excess and missing volume are sampled.
SolidError compare_solids(const geometry::TriangleMesh& truth,
                          const geometry::TriangleMesh& mesh,
                          const SolidErrorOptions& options = {});

}  // namespace atrium::test
