#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <algorithm>
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
    void smooth_normals();
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
    const auto visit_box = [&](const Eigen::Array3i& from, const Eigen::Array3i& to) {
        const Eigen::Array3i low = from.max(0);
        const Eigen::Array3i high = to.min(dims_ - 1);
        if (low.x() > high.x()) return;
        // cells of a row lie one after the other in memory
        for (int z = low.z(); z <= high.z(); ++z) {
            for (int y = low.y(); y <= high.y(); ++y) {
                const std::uint32_t end = cell_begin_[cell_index(high.x(), y, z) + 1];
                for (std::uint32_t i = cell_begin_[cell_index(low.x(), y, z)]; i < end; ++i) {
                    const float distance_sq = (samples_[i].position - position).squaredNorm();
                    if (distance_sq >= best_sq || !accept(samples_[i])) continue;
                    best_sq = distance_sq;
                    best = &samples_[i];
                }
            }
        }
    };
    const auto visit_around = [&](float reach_m) {
        visit_box(cell_of((position.array() - reach_m).matrix()),
                  cell_of((position.array() + reach_m).matrix()));
    };
    // mostly the nearest is in the cell itself or just beside it: the more is known, the less is
    // looked at
    const Eigen::Array3i centre = cell_of(position);
    visit_box(centre, centre);
    const float near_m = 0.5F * cell_m_;
    if (best_sq > near_m * near_m) visit_around(std::min(std::sqrt(best_sq), near_m));
    visit_around(std::sqrt(best_sq));
    if (best == nullptr) return std::nullopt;
    return *best;
}

}  // namespace atrium::physics
