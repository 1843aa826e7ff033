#pragma once

#include "world_server/physics/surface_index.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
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
/// that explains most points and agrees with the neighbours.
///
/// In the end all regions are solved together: each moves and turns, and neighbours move as if they
/// were one piece unless their points say otherwise (as-rigid-as-possible, Sorkine and Alexa 2007,
/// here for small turns and with couplings that let go). So directions that a region's normals do
/// not tell (a forearm along itself) come from its neighbours; a weak pull towards what the place
/// did before takes the flicker out.
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
    struct Neighbour {
        std::uint32_t region = 0;
        float num_pairs = 0.0F;  // of points, one of each, that lie side by side
    };
    struct Region {
        std::uint64_t key = 0;
        std::uint32_t first = 0;  // of points_
        std::uint32_t num = 0;
        Eigen::Vector3f centre = Eigen::Vector3f::Zero();
        Eigen::Vector3f displacement = Eigen::Vector3f::Zero();
        Eigen::Vector3f turn = Eigen::Vector3f::Zero();       // about the centre [rad]
        Eigen::Vector3f from_rest = Eigen::Vector3f::Zero();  // the displacement found from there
        float cost = 0.0F;
        bool is_hard = false;  // neither rest nor what was before explains it
        std::vector<Neighbour> neighbours;
        std::vector<Eigen::Vector3f> starts;
        std::size_t num_expected = 0;  // of the starts: what the place did before
    };
    using Matrix6 = Eigen::Matrix<float, 6, 6>;
    using Vector6 = Eigen::Matrix<float, 6, 1>;
    struct Coupling {  // of a region with a neighbour
        std::uint32_t other = 0;
        float weight = 0.0F;
        Eigen::Vector3f arm;  // to the neighbour's centre
    };
    struct Equations {  // of a region's displacement and turn
        Matrix6 lhs = Matrix6::Zero();
        Vector6 rhs = Vector6::Zero();
        std::vector<Coupling> couplings;
    };
    struct Moved {  // what a region did last time
        Eigen::Vector3f centre = Eigen::Vector3f::Zero();
        Eigen::Vector3f displacement = Eigen::Vector3f::Zero();
        Eigen::Vector3f turn = Eigen::Vector3f::Zero();
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
    void start_from_before();
    void start_from_votes();
    void vote(std::span<const std::uint32_t> regions);
    void choose_start(Region& region, std::size_t first) const;
    void choose_with_neighbours();
    void solve_together();
    Equations equations_of(const Region& region) const;
    void add_couplings(const Region& region, Equations& equations) const;
    std::optional<Eigen::Vector3f> predicted(const Region& region) const;
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
    std::vector<Moved> previous_;
};

}  // namespace atrium::physics
