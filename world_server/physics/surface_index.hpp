#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace atrium::physics {

/// A point of a surface with its unit normal, outwards.
struct SurfaceSample {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;
};

struct SamplingOptions {
    double spacing_m = 0.02;         // one sample per square of this side
    std::size_t max_samples = 6000;  // of one mesh; a larger surface is sampled more sparsely
};

/// Points evenly spread over a mesh, found by nearness. Immutable after construction and then safe
/// to share between threads.
class SurfaceIndex {
public:
    /// Vertices must be finite. Deterministic.
    SurfaceIndex(const geometry::TriangleMesh& mesh, const SamplingOptions& options);

    std::span<const SurfaceSample> samples() const { return samples_; }
    const geometry::Aabb& bounds() const { return bounds_; }

    /// The nearest sample within `radius_m` of `position` for which `accept(sample)` holds.
    template <typename Accept>
    std::optional<SurfaceSample> nearest(const Eigen::Vector3f& position,
                                         float radius_m,
                                         const Accept& accept) const;

private:
    void take_samples(const geometry::TriangleMesh& mesh, const SamplingOptions& options);
    void sort_into_cells();
    bool is_near(const Eigen::Vector3f& position, float radius_m) const {
        const Eigen::Array3d p = position.cast<double>().array();
        return (p >= bounds_.min.array() - radius_m).all() &&
               (p <= bounds_.max.array() + radius_m).all();
    }
    Eigen::Array3i cell_of(const Eigen::Vector3f& position) const {
        return ((position - origin_) / cell_m_).array().floor().cast<int>();
    }
    std::size_t cell_index(int x, int y, int z) const {
        return static_cast<std::size_t>((z * dims_.y() + y) * dims_.x() + x);
    }

    geometry::Aabb bounds_;
    std::vector<SurfaceSample> samples_;     // ordered by cell
    std::vector<std::uint32_t> cell_begin_;  // samples of cell i: [cell_begin_[i], [i + 1])
    Eigen::Array3i dims_ = Eigen::Array3i::Zero();
    Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();
    float cell_m_ = 0.0F;
};

template <typename Accept>
std::optional<SurfaceSample> SurfaceIndex::nearest(const Eigen::Vector3f& position,
                                                   float radius_m,
                                                   const Accept& accept) const {
    if (samples_.empty() || !is_near(position, radius_m)) return std::nullopt;
    const SurfaceSample* best = nullptr;
    float best_sq = radius_m * radius_m;
    const Eigen::Array3i centre = cell_of(position);
    const auto visit = [&](int x, int y, int z) {
        const std::size_t cell = cell_index(x, y, z);
        for (std::uint32_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i) {
            const float distance_sq = (samples_[i].position - position).squaredNorm();
            if (distance_sq < best_sq && accept(samples_[i])) {
                best_sq = distance_sq;
                best = &samples_[i];
            }
        }
    };
    // shells of cells of growing size; whatever lies beyond shell r is farther than r cells
    const int num_shells = static_cast<int>(std::ceil(radius_m / cell_m_)) + 1;
    for (int r = 0; r <= num_shells; ++r) {
        const Eigen::Array3i low = (centre - r).max(0);
        const Eigen::Array3i high = (centre + r).min(dims_ - 1);
        for (int z = low.z(); z <= high.z(); ++z) {
            for (int y = low.y(); y <= high.y(); ++y) {
                const bool whole_row =
                    std::abs(z - centre.z()) == r || std::abs(y - centre.y()) == r;
                if (whole_row) {
                    for (int x = low.x(); x <= high.x(); ++x) visit(x, y, z);
                } else if (low.x() <= high.x()) {
                    if (centre.x() - r == low.x()) visit(low.x(), y, z);
                    if (centre.x() + r == high.x()) visit(high.x(), y, z);
                }
            }
        }
        const float reached_m = static_cast<float>(r) * cell_m_;
        if (best_sq <= reached_m * reached_m) break;
    }
    if (best == nullptr) return std::nullopt;
    return *best;
}

}  // namespace atrium::physics
