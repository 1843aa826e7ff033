#pragma once

#include "world_server/physics/surface_index.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace atrium::physics {

struct MotionOptions {
    double region_m = 0.14;         // of the lattice whose cells move as one
    std::size_t max_points = 2000;  // of a mesh whose motion is looked up
    double max_step_m = 0.5;        // between two meshes
};

/// How each part of a surface has moved between two meshes that have nothing in common.
///
/// The later surface is cut into regions along a lattice. A region's displacement is found by
/// iterated closest points, from the later surface back to the earlier: each point is matched with
/// the nearest sample that faces the same way at the place that the current displacement gives.
/// That needs a start close to the truth, of which several are tried: rest, what the place did
/// before, what the neighbours do, and, for a region that nothing explains, the displacements that
/// most pairs of a point that appeared and a sample that vanished have in common. The start wins
/// that explains most points and agrees with the neighbours. In the end all regions are solved
/// together with a weak coupling, so that directions that a region's normals do not tell (a forearm
/// along itself) come from its neighbours.
class MotionEstimator {
public:
    explicit MotionEstimator(const MotionOptions& options);

    /// Of each sample of `now` [m]: of its region, blended into those of the regions beside it that
    /// move alike. Deterministic; not thread-safe.
    void estimate(const SurfaceIndex& now,
                  const SurfaceIndex& before,
                  std::vector<Eigen::Vector3f>& displacements);

    /// The next surfaces have nothing to do with the last.
    void forget() { previous_.clear(); }

private:
    struct Region {
        std::uint64_t key = 0;
        std::uint32_t first = 0;  // of points_
        std::uint32_t num = 0;
        Eigen::Vector3f centre = Eigen::Vector3f::Zero();
        Eigen::Vector3f displacement = Eigen::Vector3f::Zero();
        float cost = 0.0F;
        bool is_hard = false;  // rest does not explain it
        std::vector<std::uint32_t> neighbours;
        std::vector<Eigen::Vector3f> starts;
        std::size_t num_expected = 0;  // of the starts: what the place did before
    };
    struct Moved {  // what a region did last time
        Eigen::Vector3f centre;
        Eigen::Vector3f displacement;
    };
    struct Normals {  // normal equations of `normal . step = distance`
        Eigen::Matrix3f lhs = Eigen::Matrix3f::Zero();
        Eigen::Vector3f rhs = Eigen::Vector3f::Zero();
        float weight = 0.0F;
        float cost = 0.0F;  // mean over the points, 0 .. 1
    };

    void make_regions();
    void link_regions();
    Normals correspond(const Region& region,
                       const Eigen::Vector3f& displacement,
                       std::size_t max_points = std::numeric_limits<std::size_t>::max()) const;
    Eigen::Vector3f refine(const Region& region, Eigen::Vector3f displacement, int rounds) const;
    void start_from_rest(Region& region);
    void add_previous_starts();
    void add_voted_starts();
    void vote(std::span<const std::uint32_t> regions);
    void choose_starts();
    void choose_with_neighbours();
    void solve_together();
    Eigen::Vector3f displacement_at(std::size_t sample) const;
    float mismatch(const SurfaceSample& sample, const Eigen::Vector3f& displacement) const;

    MotionOptions options_;
    const SurfaceIndex* now_ = nullptr;
    const SurfaceIndex* before_ = nullptr;
    struct Point {
        std::uint64_t key = 0;
        std::uint32_t sample = 0;
        bool is_explained = false;
    };
    std::vector<Point> points_;  // ordered by region
    struct Octant {
        std::uint64_t key = 0;
        bool moves = false;
    };
    std::vector<Octant> octants_;          // of the lattice's cells, ordered by key
    std::vector<std::uint32_t> vanished_;  // samples of before_ that rest does not explain
    std::vector<Region> regions_;          // ordered by key
    std::vector<std::uint16_t> votes_;
    std::vector<Normals> normals_;
    std::vector<Moved> previous_;
};

}  // namespace atrium::physics
