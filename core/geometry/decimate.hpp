#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <cstddef>
#include <memory>

namespace atrium::geometry {

struct DecimateOptions {
    double max_distance_m = 5e-3;
    std::size_t target_triangles = 0;  // stops at this number or below
};

struct DecimateReport {
    /// Proven bound: no point of either surface is further than this from the other surface.
    double distance_bound_m = 0.0;
    std::size_t num_collapses = 0;
    bool reached_target = false;  // at most `target_triangles` are left
};

/// Working memory of `decimate`, for one caller at a time. Grows to the largest input, then is
/// reused.
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

/// Simplifies a closed mesh by edge collapses while the surface stays within
/// `options.max_distance_m`.
///
/// `out` (not `in` itself) has a subset of the vertices of `in`, in their order. It is closed and
/// 2-manifold with the components and Euler characteristic of `in`. No step flips a triangle;
/// self-intersections are not checked. The result is deterministic to the bit. An empty mesh is
/// valid. Fails with kInvalidData unless `in` is closed and 2-manifold with coordinates up to 1000
/// km, with kConfiguration unless the distance is finite and not negative; `out` is then empty.
///
/// Why the bound holds: each step merges a vertex into a neighbour and has a continuous map of the
/// old surface onto the new one (`CollapseMap`). All steps together map the whole input onto the
/// whole output. Each triangle keeps a box around the displacements of all input points mapped to
/// it, and a step is made only if no box exceeds the bound. Every input point thus has an output
/// point within the bound, and since the map covers the output, also the reverse. Rounding is
/// included.
///
/// Steps are ordered by quadrics (Garland, Heckbert, "Surface Simplification Using Quadric Error
/// Metrics", 1997).
Expected<DecimateReport> decimate(const TriangleMesh& in,
                                  const DecimateOptions& options,
                                  DecimateScratch& scratch,
                                  TriangleMesh& out);

}  // namespace atrium::geometry
