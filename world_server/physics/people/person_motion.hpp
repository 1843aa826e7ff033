#pragma once

#include "world_server/physics/options/people_options.hpp"
#include "world_server/physics/people/float4.hpp"
#include "world_server/physics/people/surface_index.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace atrium::physics {

/// Estimates how each part of a surface has moved between two meshes without common vertices.
///
/// 1. The later surface is cut into regions along a lattice.
/// 2. Iterated closest points finds the displacement of each region, from the later surface back to
///    the earlier one. Each point is matched with the nearest sample that faces the same way at the
///    displaced position.
/// 3. This needs a start close to the truth. Candidates are rest, the previous motion at that
///    place, the motion of neighbours, and votes. Votes serve regions that nothing else explains:
///    the displacements shared by most pairs of an appeared point and a vanished sample. The
///    candidate wins that explains most points and agrees with the neighbours.
/// 4. All regions are solved together. Each has a displacement and a rotation. Neighbours move as
///    one piece unless their points disagree (as-rigid-as-possible, Sorkine and Alexa 2007, here
///    for small rotations and with couplings that let go). Directions that a region's normals do
///    not determine, such as a forearm along itself, therefore come from its neighbours. A weak
///    pull towards the previous motion removes flicker.
class MotionEstimator {
public:
    explicit MotionEstimator(const MotionOptions& options);

    /// Computes the displacement [m] of each sample of `now`: that of its region, blended with
    /// adjacent regions that move alike. Deterministic. Not thread-safe.
    void estimate(const SurfaceIndex& now,
                  const SurfaceIndex& before,
                  std::vector<Eigen::Vector3f>& displacements);

    /// Forgets the previous motion: the next surfaces are unrelated to the last.
    void forget() { previous_.clear(); }

private:
    static constexpr std::size_t kMaxPrevious = 3;  // starts from the previous motion of regions
    static constexpr std::size_t kNumPeaks = 4;     // starts from votes
    static constexpr std::uint32_t kNoRegion = std::numeric_limits<std::uint32_t>::max();

    struct Region {
        bool moves = false;       // the part of the lattice cell that has left its place
        std::uint32_t first = 0;  // first index in points_
        std::uint32_t num = 0;
        std::uint32_t sibling = kNoRegion;  // the other region of the same lattice cell
        std::uint32_t first_neighbour = 0;  // first index in neighbours_
        std::uint32_t num_neighbours = 0;
        Eigen::Vector3f centre = Eigen::Vector3f::Zero();
        Eigen::Vector3f displacement = Eigen::Vector3f::Zero();
        Eigen::Vector3f turn = Eigen::Vector3f::Zero();  // rotation about the centre [rad]
        // displacement found with rest as the start
        Eigen::Vector3f from_rest = Eigen::Vector3f::Zero();
        std::optional<Eigen::Vector3f> predicted;  // previous motion of the body part at this place
        float cost = 0.0F;
        bool is_hard = false;  // neither rest nor the previous motion explains it
        std::array<Eigen::Vector3f, kMaxPrevious + kNumPeaks> starts;
        std::size_t num_starts = 0;
        std::size_t num_expected = 0;  // of the starts, those from the previous motion
    };
    struct Neighbour {
        std::uint32_t region = 0;
        float num_pairs = 0.0F;  // adjacent pairs of points, one from each region
        float nearness = 0.0F;   // weight of its displacement
    };
    struct Point {
        std::uint32_t sample = 0;
        // matching sample of before_ if the point is at rest
        std::uint32_t at_rest = SurfaceIndex::kNone;
        bool is_explained = false;
    };
    // A lattice over the surface. For very large surfaces its cells grow.
    struct Lattice {
        void fit(const geometry::Aabb& bounds, double wanted_m);
        Int4 cell_at(const Eigen::Vector3f& position) const;
        std::size_t index_of(const Eigen::Vector3f& position) const {
            return index_of(cell_at(position));
        }
        std::size_t index_of(Int4 cell) const {
            return static_cast<std::size_t>((cell[2] * dims.y() + cell[1]) * dims.x() + cell[0]);
        }
        std::size_t num_cells = 0;
        float cell_m = 0.0F;
        Eigen::Array3i dims = Eigen::Array3i::Ones();
        Float4 low{};  // cell with index 0, counted from the world's origin
        Float4 high{};
    };
    struct Octant {  // eighth part of a lattice cell
        std::uint16_t num = 0;
        std::uint16_t num_unexplained = 0;
        bool moves(float moving_share) const;
    };
    using Matrix6 = Eigen::Matrix<float, 6, 6>;
    using Vector6 = Eigen::Matrix<float, 6, 1>;
    struct Twist {  // the fourth lane of each is 0
        Float4 displacement{};
        Float4 turn{};
    };
    struct Coupling {  // couples a region with a neighbour
        Float4 weight{};
        Float4 weighted_arm{};  // vector to the neighbour's centre
        Float4 weighted_arm_yzx{};
    };
    struct Equations {                      // solves for a region's displacement and rotation
        Matrix6 own_lhs = Matrix6::Zero();  // from its points and its previous motion
        Twist own_rhs;
        std::array<Twist, 6> inverse{};  // columns; includes all couplings
        Twist state;
        Twist linearised_at;
        Twist seen_by_neighbours;  // the state that its neighbours already use
        bool is_stale = true;      // moved since the equations were built
        bool is_due = true;        // a neighbour has moved
    };
    struct Moved {  // motion of a region in the previous call
        Eigen::Vector3f centre = Eigen::Vector3f::Zero();
        Eigen::Vector3f displacement = Eigen::Vector3f::Zero();
        Eigen::Vector3f turn = Eigen::Vector3f::Zero();
    };
    struct Normals {  // normal equations of `normal . step = distance`
        Eigen::Matrix3f lhs = Eigen::Matrix3f::Zero();
        Eigen::Vector3f rhs = Eigen::Vector3f::Zero();
        float weight = 0.0F;
        float cost = 0.0F;  // mean over the points, 0 to 1
    };
    // motion of a region near the samples, each value four times; see `blend_regions`
    struct Blend {
        std::array<Float4, 3> centre;
        std::array<Float4, 3> turn;
        std::array<Float4, 3> constant;  // displacement at the world's origin
        Float4 alike;
    };

    std::span<const Neighbour> neighbours_of(const Region& region) const {
        return {neighbours_.data() + region.first_neighbour, region.num_neighbours};
    }
    void make_regions();
    void match_places(const SurfaceIndex& surface);
    void sort_points_by_region();
    void link_regions();
    void count_pairs();
    void predict();
    Normals correspond(const Region& region,
                       const Eigen::Vector3f& displacement,
                       std::size_t max_points);
    Eigen::Vector3f refine(const Region& region, Eigen::Vector3f displacement, int rounds);
    void start_from_rest(Region& region);
    void start_from_before();
    void start_from_votes();
    void vote(std::span<const std::uint32_t> regions);
    void choose_start(Region& region, std::size_t first);
    void choose_with_neighbours();
    void solve_together();
    void linearise(const Region& region, Equations& equations);
    void couple(std::size_t index);
    void sweep();
    bool relax(std::size_t index);
    void blend_regions();
    void sort_samples_by_region();
    void displace(std::vector<Eigen::Vector3f>& displacements);
    std::uint32_t region_of(const Eigen::Vector3f& position) const;
    void blend(std::uint32_t region,
               std::span<const std::uint32_t> samples,
               std::vector<Eigen::Vector3f>& displacements) const;
    std::optional<Eigen::Vector3f> displacement_of_another(const Region& own,
                                                           const SurfaceSample& sample) const;
    Eigen::Vector3f blended_as(const Region& own,
                               const Region& region,
                               const Eigen::Vector3f& position) const;
    float mismatch(const SurfaceSample& sample, const Eigen::Vector3f& displacement) const;

    MotionOptions options_;
    const SurfaceIndex* now_ = nullptr;
    const SurfaceIndex* before_ = nullptr;
    std::vector<Point> points_;  // ordered by region
    std::vector<Point> unsorted_;
    std::vector<SurfaceSample> places_;  // places to match; scratch
    std::vector<std::uint32_t> matched_;
    Lattice octant_lattice_;
    Lattice region_lattice_;
    std::vector<Octant> octants_;             // one per cell of octant_lattice_
    std::vector<std::uint32_t> region_at_;    // two per cell of region_lattice_: resting, moving
    std::vector<std::uint32_t> vanished_;     // samples of before_ that rest does not explain
    std::vector<Region> regions_;             // ordered by cell
    std::vector<Neighbour> neighbours_;       // ordered by region, then by neighbour
    std::vector<Coupling> couplings_;         // one per neighbour
    std::vector<Equations> equations_;        // of each region
    std::vector<Blend> blends_;               // ordered by region
    std::vector<std::uint32_t> first_blend_;  // one per region, plus the end
    std::vector<std::uint8_t> may_differ_;    // one per region: adjacent regions move differently
    std::vector<std::uint32_t> region_of_sample_;
    // index in sorted_samples_, one per region, plus the end
    std::vector<std::uint32_t> first_sample_;
    std::vector<std::uint32_t> sorted_samples_;  // ordered by region
    std::vector<std::uint16_t> votes_;
    std::vector<Moved> previous_;
    std::array<std::vector<float>, 3> headed_;  // predicted centres of previous_, by coordinate
    struct Link {  // links touching regions; its index ^ 1 is the reverse link
        std::uint32_t to = 0;
        std::uint32_t num_pairs = 0;
        std::uint32_t next = 0;  // next link of the same region
    };
    std::vector<Link> links_;  // this and the following members are scratch
    std::vector<std::uint32_t> first_link_;
    Lattice touch_lattice_;
    std::vector<std::uint32_t> touch_begin_;
    struct Placed {
        Int4 cell{};  // the fourth lane is the cell's index
        std::uint32_t region = 0;
    };
    std::vector<Placed> placed_unsorted_;
    std::vector<Placed> placed_;                   // points ordered by cell
    std::array<std::vector<float>, 3> placed_at_;  // positions of placed_ by coordinate, for SIMD
    std::vector<std::uint32_t> placed_region_;
    std::vector<std::uint32_t> slots_;  // index in region_at_, one per entry of unsorted_
};

}  // namespace atrium::physics
