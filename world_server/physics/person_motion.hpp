#pragma once

#include "world_server/physics/float4.hpp"
#include "world_server/physics/surface_index.hpp"

#include <Eigen/Core>

#include <array>
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
    static constexpr std::size_t kMaxPrevious = 3;  // starts from what regions did before
    static constexpr std::size_t kNumPeaks = 4;     // starts from votes
    static constexpr std::uint32_t kNoRegion = std::numeric_limits<std::uint32_t>::max();

    struct Region {
        bool moves = false;       // of its lattice cell, the part that left its place
        std::uint32_t first = 0;  // of points_
        std::uint32_t num = 0;
        std::uint32_t sibling = kNoRegion;  // the other part of its lattice cell
        std::uint32_t first_neighbour = 0;  // of neighbours_
        std::uint32_t num_neighbours = 0;
        Eigen::Vector3f centre = Eigen::Vector3f::Zero();
        Eigen::Vector3f displacement = Eigen::Vector3f::Zero();
        Eigen::Vector3f turn = Eigen::Vector3f::Zero();       // about the centre [rad]
        Eigen::Vector3f from_rest = Eigen::Vector3f::Zero();  // the displacement found from there
        std::optional<Eigen::Vector3f> predicted;  // what the part of the body there did before
        float cost = 0.0F;
        bool is_hard = false;  // neither rest nor what was before explains it
        std::array<Eigen::Vector3f, kMaxPrevious + kNumPeaks> starts;
        std::size_t num_starts = 0;
        std::size_t num_expected = 0;  // of the starts: what the place did before
    };
    struct Neighbour {
        std::uint32_t region = 0;
        float num_pairs = 0.0F;  // of points, one of each, that lie side by side
        float nearness = 0.0F;   // weight of its opinion
    };
    struct Point {
        std::uint32_t sample = 0;
        std::uint32_t at_rest = SurfaceIndex::kNone;  // sample of before_ that it is, if it rests
        bool is_explained = false;
    };
    // A lattice over the surface. Where the surface claims to be huge, its cells are larger.
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
        Float4 low{};  // cell with index 0, from the world's origin
        Float4 high{};
    };
    struct Octant {  // of a lattice cell
        std::uint16_t num = 0;
        std::uint16_t num_unexplained = 0;
        bool moves() const;
    };
    using Matrix6 = Eigen::Matrix<float, 6, 6>;
    using Vector6 = Eigen::Matrix<float, 6, 1>;
    struct Twist {  // the fourth of each is 0
        Float4 displacement{};
        Float4 turn{};
    };
    struct Coupling {  // of a region with a neighbour
        Float4 weight{};
        Float4 weighted_arm{};  // to the neighbour's centre
        Float4 weighted_arm_yzx{};
    };
    struct Equations {                      // of a region's displacement and turn
        Matrix6 own_lhs = Matrix6::Zero();  // of its points and its past
        Twist own_rhs;
        std::array<Twist, 6> inverse{};  // columns, with all couplings
        Twist state;
        Twist linearised_at;
        Twist told;            // the state that neighbours have taken account of
        bool is_stale = true;  // has moved since its equations were made
        bool is_due = true;    // a neighbour has moved
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
    struct Blend {  // a region around samples, each value four times; see `blend_regions`
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
    std::vector<SurfaceSample> places_;  // to match, scratch
    std::vector<std::uint32_t> matched_;
    Lattice octant_lattice_;
    Lattice region_lattice_;
    std::vector<Octant> octants_;             // of octant_lattice_
    std::vector<std::uint32_t> region_at_;    // two of each cell of region_lattice_: still, moving
    std::vector<std::uint32_t> vanished_;     // samples of before_ that rest does not explain
    std::vector<Region> regions_;             // ordered by cell
    std::vector<Neighbour> neighbours_;       // ordered by region, then by neighbour
    std::vector<Coupling> couplings_;         // of each of these
    std::vector<Equations> equations_;        // of each region
    std::vector<Blend> blends_;               // ordered by region
    std::vector<std::uint32_t> first_blend_;  // of each region, and the end
    std::vector<std::uint8_t> may_differ_;    // of each region: what is beside it moves otherwise
    std::vector<std::uint32_t> region_of_sample_;
    std::vector<std::uint32_t> first_sample_;    // of sorted_samples_, of each region, and the end
    std::vector<std::uint32_t> sorted_samples_;  // ordered by region
    std::vector<std::uint16_t> votes_;
    std::vector<Moved> previous_;
    std::array<std::vector<float>, 3> headed_;  // where each of these was headed, by coordinate
    struct Link {  // of regions that touch; the next or the one before is the way back
        std::uint32_t to = 0;
        std::uint32_t num_pairs = 0;
        std::uint32_t next = 0;  // of the same `from`
    };
    std::vector<Link> links_;  // scratch, as are the next
    std::vector<std::uint32_t> first_link_;
    Lattice touch_lattice_;
    std::vector<std::uint32_t> touch_begin_;
    struct Placed {
        Int4 cell{};  // the fourth is its index
        std::uint32_t region = 0;
    };
    std::vector<Placed> placed_unsorted_;
    std::vector<Placed> placed_;                   // points ordered by cell
    std::array<std::vector<float>, 3> placed_at_;  // positions of these by coordinate, for SIMD
    std::vector<std::uint32_t> placed_region_;
    std::vector<std::uint32_t> slots_;  // of region_at_, of each of unsorted_
};

}  // namespace atrium::physics
