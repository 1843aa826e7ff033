#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <cstddef>
#include <memory>

namespace atrium::geometry {

struct DecimateOptions {
    double max_distance_m = 5e-3;
    std::size_t target_triangles = 0;  // ends once there are no more than these
};

struct DecimateReport {
    /// Proven: no point of either surface is further than this from the other one.
    double distance_bound_m = 0.0;
    std::size_t num_collapses = 0;
    bool reached_target = false;  // of `target_triangles`
};

/// Working memory of one caller; grows to the largest input and is then reused.
class DecimateScratch {
public:
    DecimateScratch();
    ~DecimateScratch();
    DecimateScratch(DecimateScratch&&) noexcept;
    DecimateScratch& operator=(DecimateScratch&&) noexcept;

    struct Data;
    Data& data() { return *data_; }

private:
    std::unique_ptr<Data> data_;
};

/// Leaves out vertices of a closed mesh while its surface stays within `options.max_distance_m`.
///
/// `out` (not `in` itself) has some of the vertices of `in`, in their order, and is closed and
/// 2-manifold with the components and Euler characteristic of `in`. No step turns a triangle over;
/// it is not checked whether the surface comes to cut through itself.
/// The same input gives the same bits. An empty mesh is fine. kInvalidData unless `in` is closed
/// and 2-manifold, with coordinates below 1000 km; kConfiguration unless the distance is finite and
/// not negative; then `out` is empty.
///
/// Why the bound holds. Each step moves a vertex into a neighbour and comes with a continuous map
/// of the old surface onto the new one (`CollapseMap`); so all steps together map the whole input
/// onto the whole output. Each triangle keeps a box around the displacements of all input points
/// that have come to lie in it, and a step is only made where no box reaches further than allowed.
/// Every point of the input thus has one of the output within the bound, and as nothing of the
/// output is left uncovered, the other way round. Rounding is included.
///
/// The order is that of quadrics (Garland, Heckbert, "Surface Simplification Using Quadric Error
/// Metrics", 1997).
Expected<DecimateReport> decimate(const TriangleMesh& in,
                                  const DecimateOptions& options,
                                  DecimateScratch& scratch,
                                  TriangleMesh& out);

}  // namespace atrium::geometry
