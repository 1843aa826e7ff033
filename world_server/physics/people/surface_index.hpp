#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/options/people_options.hpp"
#include "world_server/physics/people/float4.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace atrium::physics {

/// A point of a surface with its outward unit normal.
struct SurfaceSample {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;
};

/// Samples a mesh evenly and finds the nearest samples of places. Immutable after `assign`; then
/// safe to share between threads. Every instruction set gives the same bits.
class SurfaceIndex {
public:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

    SurfaceIndex() = default;
    SurfaceIndex(const geometry::TriangleMesh& mesh, const SamplingOptions& options) {
        assign(mesh, options);
    }

    /// Samples another mesh. Reuses the memory. Vertices must be finite. Deterministic.
    void assign(const geometry::TriangleMesh& mesh, const SamplingOptions& options);

    std::span<const SurfaceSample> samples() const { return samples_; }  // ordered by cell
    const geometry::Aabb& bounds() const { return bounds_; }

    /// Finds for each of `places` the nearest sample within `radius_m` whose normal has a cosine
    /// above `min_cosine` with the place's normal; kNone if there is none. One call with many
    /// places is faster than many calls. `found` must have the length of `places`.
    void nearest(std::span<const SurfaceSample> places,
                 float radius_m,
                 float min_cosine,
                 std::span<std::uint32_t> found) const;

    /// For tests: uses the code without AVX2.
    void forbid_avx2() { may_use_avx2_ = false; }

private:
    struct Search;  // compiled for several instruction sets
    struct Smoothing;
    using Columns = std::array<std::vector<float>, 6>;  // x, y, z of position, then of normal

    bool uses_avx2() const;
    void take_samples(const geometry::TriangleMesh& mesh, const SamplingOptions& options);
    void sort_into_cells(double min_cell_m);
    void fill_columns();
    void smooth_normals(float radius_m);
    void bundle();
    std::size_t cell_index(int x, int y, int z) const {
        return static_cast<std::size_t>((z * dims_.y() + y) * dims_.x() + x);
    }
    Int4 cell_at(const Eigen::Vector3f& position) const;  // clamped to the grid

    geometry::Aabb bounds_;
    std::vector<SurfaceSample> samples_;     // ordered by cell
    std::vector<std::uint32_t> cell_begin_;  // samples of cell i: [cell_begin_[i], [i + 1])
    // The rows of cells along x again, four side by side in a bundle. Each place thus has one
    // bundle with everything near it: bundle (y, z) holds the rows y - 1 and y of z - 1 and z.
    Columns bundled_;  // ordered by bundle, then by x; padded with far samples
    std::vector<std::uint32_t> bundled_sample_;
    std::vector<std::uint32_t> bundle_begin_;  // per cell x of a bundle, like cell_begin_
    Eigen::Array3i dims_ = Eigen::Array3i::Zero();
    Float4 origin_{};     // x, y, z, x
    Float4 last_cell_{};  // x, y, z, x of the last cell
    float cell_m_ = 1.0F;
    float cells_per_m_ = 1.0F;
    bool may_use_avx2_ = true;
    // Scratch of `assign`.
    Columns columns_;  // of samples_; padded with far samples
    Columns around_;
    std::vector<double> doubled_areas_;
    std::vector<std::uint32_t> cell_of_sample_;
    std::vector<SurfaceSample> unsorted_;
};

}  // namespace atrium::physics
