#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/face_owner.hpp"
#include "site_node/refine/point_grid.hpp"
#include "site_node/refine/surfel_rows.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::refine {

/// A sample of a visual hull's surface.
struct Surfel {
    Eigen::Vector3f position_site = Eigen::Vector3f::Zero();  // [m]
    Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();        // unit, outwards, smoothed
    std::int32_t owner = hull::kNoOwner;  // view whose outline made the surface here
    float thickness_m = 0.0F;             // from here inwards to the opposite surface
};

struct SurfelOptions {
    float spacing_m = 0.02F;
    float neighbourhood_m = 0.036F;  // radius over which normals are smoothed and neighbours joined
    float most_thickness_m = 0.2F;   // thicker parts have this thickness
};

/// Evenly spaced samples of a hull, and which of them are neighbours on the surface: near, and with
/// similar normals. Deterministic. Keeps its memory. Not thread-safe while `sample` runs.
class Surfels {
public:
    struct Neighbour {
        std::uint32_t surfel = 0;
        float weight = 0.0F;  // falls with distance and with the angle between the normals
    };

    /// Samples `mesh`, the hull of views whose centres of projection are `centres_site`.
    void sample(const geometry::TriangleMesh& mesh,
                std::span<const Eigen::Vector3d> centres_site,
                const SurfelOptions& options,
                Executor& executor);

    std::size_t size() const { return surfels_.size(); }
    const Surfel& operator[](std::size_t i) const { return surfels_[i]; }
    std::span<const Neighbour> neighbours(std::size_t i) const {
        return {neighbours_.data() + begins_[i], begins_[i + 1] - begins_[i]};
    }
    /// Finds surfels near any point; see `find_near`.
    void near(const Eigen::Vector3f& centre_site, float radius_m, NearScratch& scratch) const;
    /// Per triangle of the mesh: the view whose outline made it, or hull::kNoOwner.
    std::span<const std::int32_t> face_owners() const { return face_owners_; }

private:
    static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

    // Samples of one cell of space whose faces look in a similar direction.
    struct Sum {
        Eigen::Vector3f position = Eigen::Vector3f::Zero();  // times area
        Eigen::Vector3f normal = Eigen::Vector3f::Zero();    // times area
        float area_m2 = 0.0F;
        std::int32_t owner = hull::kNoOwner;  // of the largest part of the area, by majority vote
        float lead_m2 = 0.0F;
    };
    struct Slot {
        std::uint64_t key = kEmpty;
        std::uint32_t sum = 0;
    };

    void add_samples(const geometry::TriangleMesh& mesh,
                     std::span<const Eigen::Vector3d> centres_site,
                     float spacing_m);
    Sum& sum_of(std::uint64_t key);
    void grow();
    void sort_by_place(float cell_m);
    void find_runs(const Eigen::Vector3f& centre_site,
                   float radius_m,
                   std::vector<SurfelRun>& runs) const;
    void join_neighbours(const SurfelOptions& options, Executor& executor);
    void find_thickness(const SurfelOptions& options, Executor& executor);

    std::vector<Slot> slots_;  // hash table with linear probing; its size is a power of two
    std::vector<Sum> sums_;
    std::vector<std::int32_t> face_owners_;
    std::vector<Surfel> unsorted_;
    std::vector<Eigen::Vector3f> points_;  // of `unsorted_`
    PointGrid grid_;
    std::vector<Surfel> surfels_;  // in the order of the grid
    SurfelRows rows_;
    std::vector<Eigen::Vector3f> smoothed_;
    std::vector<std::uint32_t> begins_{0};  // per surfel, and one more: first in `neighbours_`
    std::vector<Neighbour> neighbours_;
    std::vector<std::vector<Neighbour>> found_;  // per chunk
    std::vector<NearScratch> near_;              // per worker
};

/// Falls smoothly from 1 to 0 while `share`, a squared distance over that of a radius, rises to 1.
inline float falling_weight(float share) {
    const float left = std::max(0.0F, 1.0F - share);
    return left * left;
}

/// Number of surfels that one task of a parallel loop takes.
inline constexpr std::size_t kChunk = 128;
inline std::size_t num_chunks(std::size_t size) { return (size + kChunk - 1) / kChunk; }

}  // namespace atrium::refine
