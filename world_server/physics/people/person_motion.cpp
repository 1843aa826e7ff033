#include "world_server/physics/people/person_motion.hpp"

#include "world_server/physics/people/float8.hpp"
#include "world_server/physics/people/motion_match.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

namespace atrium::physics {
namespace {

using motion::distance_along_normal;
using motion::is_explained_by;
using motion::kAlikeM;
using motion::match;
using motion::robust_cost;

constexpr float kMovingShare = 0.12F;  // share of an octant's points that rest does not explain
constexpr float kTouchM = 0.06F;       // distance between points of neighbouring regions
constexpr float kMismatch = 0.6F;      // cost above which a sample does not belong to its region
// Below this difference between adjacent motions, it does not matter to which region a sample
// belongs.
constexpr float kIndifferentM = 0.01F;
constexpr float kNearSq = 0.1F * 0.1F;       // [m^2] distance of neighbours with the most weight
constexpr std::size_t kMaxCells = 1U << 20;  // of a lattice

float unlike(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    const float ratio = (a - b).squaredNorm() / (kAlikeM * kAlikeM);
    return 1.0F + ratio * ratio;
}

// Replaces x by e^x, for x <= 0, with a relative error of 2e-6. Below -80 the result is that of
// -80.
ATRIUM_INLINE void exp8(Float8& x) {
    const Float8 least = Float8{} - 80.0F;
    x = x > least ? x : least;
    const Float8 halvings = x * 1.44269504F;
    // truncation leaves a rest between 0 and -1
    const Int8 whole = __builtin_convertvector(halvings, Int8);
    const Float8 rest = (halvings - __builtin_convertvector(whole, Float8)) * 0.693147181F;
    Float8 power = rest * (1.0F / 720.0F) + (1.0F / 120.0F);
    power = power * rest + (1.0F / 24.0F);
    power = power * rest + (1.0F / 6.0F);
    power = power * rest + 0.5F;
    power = power * rest + 1.0F;
    power = power * rest + 1.0F;
    x = power * reinterpret_cast<Float8>((whole + 127) << 23);
}

ATRIUM_INLINE void twice(const Float4& four, Float8& eight) {
    eight = __builtin_shufflevector(four, four, 0, 1, 2, 3, 0, 1, 2, 3);
}

// Eight places (x, y, z) on input, displacements and weights (fourth row) on output.
using Eight = std::array<std::array<float, kFloat8Size>, 4>;

template <typename Blend>
ATRIUM_INLINE void blend_eight(std::span<const Blend> blends, float per_sq, Eight& eight) {
    Float8 x, y, z;
    load8(eight[0].data(), x);
    load8(eight[1].data(), y);
    load8(eight[2].data(), z);
    Float8 weights{}, sum_x{}, sum_y{}, sum_z{};
    for (const Blend& b : blends) {
        std::array<Float8, 3> off, turn, constant;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            twice(b.centre[axis], off[axis]);
            twice(b.turn[axis], turn[axis]);
            twice(b.constant[axis], constant[axis]);
        }
        Float8 alike;
        twice(b.alike, alike);
        off[0] -= x;
        off[1] -= y;
        off[2] -= z;
        Float8 weight = (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) * per_sq;
        exp8(weight);
        weight *= alike;
        weights += weight;
        sum_x += weight * (constant[0] + turn[1] * z - turn[2] * y);
        sum_y += weight * (constant[1] + turn[2] * x - turn[0] * z);
        sum_z += weight * (constant[2] + turn[0] * y - turn[1] * x);
    }
    store8(eight[0].data(), sum_x / weights);
    store8(eight[1].data(), sum_y / weights);
    store8(eight[2].data(), sum_z / weights);
    store8(eight[3].data(), weights);
}

#ifdef ATRIUM_AVX2
template <typename Blend>
ATRIUM_AVX2 void blend_eight_avx2(std::span<const Blend> blends, float per_sq, Eight& eight) {
    blend_eight(blends, per_sq, eight);
}
#endif

}  // namespace

MotionEstimator::MotionEstimator(const MotionOptions& options) : options_(options) {
    assert(options.region_m > 0.0 && options.max_points > 0);
}

void MotionEstimator::Lattice::fit(const geometry::Aabb& bounds, double wanted_m) {
    const auto cells_of = [](const Eigen::Vector3d& p, double m) -> Eigen::Array3d {
        return (p.array() / m).floor();
    };
    double m = wanted_m;
    const auto num_for = [&] {
        return (cells_of(bounds.max, m) - cells_of(bounds.min, m) + 1.0).prod();
    };
    while (num_for() > static_cast<double>(kMaxCells)) m *= 1.5;
    cell_m = static_cast<float>(m);
    const Eigen::Array3d first = cells_of(bounds.min, m);
    const Eigen::Array3d last = cells_of(bounds.max, m);
    const auto to_float4 = [](const Eigen::Array3f& a) { return Float4{a[0], a[1], a[2], 0.0F}; };
    low = to_float4(first.cast<float>());
    high = to_float4(last.cast<float>());
    dims = (last - first).cast<int>() + 1;
    num_cells = static_cast<std::size_t>(dims.x()) * static_cast<std::size_t>(dims.y()) *
                static_cast<std::size_t>(dims.z());
}

Int4 MotionEstimator::Lattice::cell_at(const Eigen::Vector3f& position) const {
    const Float4 at = Float4{position.x(), position.y(), position.z(), 0.0F} / cell_m;
    return floor4(min4(max4(at, low), high)) - __builtin_convertvector(low, Int4);
}

bool MotionEstimator::Octant::moves() const {
    return static_cast<float>(num_unexplained) > kMovingShare * static_cast<float>(num);
}

void MotionEstimator::estimate(const SurfaceIndex& now,
                               const SurfaceIndex& before,
                               std::vector<Eigen::Vector3f>& displacements) {
    displacements.assign(now.samples().size(), Eigen::Vector3f::Zero());
    now_ = &now;
    before_ = &before;
    if (now.samples().empty() || before.samples().empty()) return previous_.clear();
    make_regions();
    link_regions();
    predict();
    for (Region& region : regions_) start_from_rest(region);
    start_from_before();
    start_from_votes();
    choose_with_neighbours();
    solve_together();
    blend_regions();
    sort_samples_by_region();
    displace(displacements);
    previous_.clear();
    for (const Region& region : regions_) {
        previous_.push_back({region.centre, region.displacement, region.turn});
    }
}

// Regions are the cells of the lattice. A cell is cut in two if only part of it has left its place:
// the octants that rest largely does not explain form a separate region.
void MotionEstimator::make_regions() {
    const auto samples = now_->samples();
    octant_lattice_.fit(now_->bounds(), 0.5 * options_.region_m);
    region_lattice_.fit(now_->bounds(), 2.0 * static_cast<double>(octant_lattice_.cell_m));
    octants_.assign(octant_lattice_.num_cells, {});
    // samples are ordered by place: every n-th sample still covers every region
    const std::size_t stride = 1 + samples.size() / options_.max_points;
    places_.clear();
    for (std::size_t i = 0; i < samples.size(); i += stride) places_.push_back(samples[i]);
    match_places(*before_);
    unsorted_.clear();
    for (std::size_t n = 0; n < places_.size(); ++n) {
        const bool is_explained = is_explained_by(*before_, matched_[n], places_[n]);
        unsorted_.push_back({static_cast<std::uint32_t>(n * stride), matched_[n], is_explained});
        Octant& octant = octants_[octant_lattice_.index_of(places_[n].position)];
        ++octant.num;
        if (!is_explained) ++octant.num_unexplained;
    }
    sort_points_by_region();
}

void MotionEstimator::match_places(const SurfaceIndex& surface) {
    matched_.resize(places_.size());
    match(surface, places_, matched_);
}

void MotionEstimator::sort_points_by_region() {
    const auto samples = now_->samples();
    region_at_.assign(2 * region_lattice_.num_cells, 0);
    slots_.clear();
    for (const Point& point : unsorted_) {
        const Eigen::Vector3f& position = samples[point.sample].position;
        const bool moves = octants_[octant_lattice_.index_of(position)].moves();
        const std::size_t slot = 2 * region_lattice_.index_of(position) + (moves ? 1 : 0);
        slots_.push_back(static_cast<std::uint32_t>(slot));
        ++region_at_[slot];
    }
    regions_.clear();
    std::uint32_t num_points = 0;
    for (std::size_t i = 0; i < region_at_.size(); ++i) {
        const std::uint32_t num = std::exchange(region_at_[i], kNoRegion);
        if (num == 0) continue;
        const auto number = static_cast<std::uint32_t>(regions_.size());
        region_at_[i] = number;
        Region& region = regions_.emplace_back();
        region.moves = i % 2 != 0;
        region.first = num_points;
        num_points += num;
        if (!region.moves || region_at_[i - 1] == kNoRegion) continue;
        region.sibling = number - 1;
        regions_[number - 1].sibling = number;
    }
    points_.resize(unsorted_.size());
    for (std::size_t i = 0; i < unsorted_.size(); ++i) {
        Region& region = regions_[region_at_[slots_[i]]];
        points_[region.first + region.num++] = unsorted_[i];
        region.centre += samples[unsorted_[i].sample].position;
    }
    for (Region& region : regions_) region.centre /= static_cast<float>(region.num);
}

// Two regions are neighbours if they have adjacent points; more pairs couple them more strongly. A
// hand in front of the chest is not a neighbour of it.
void MotionEstimator::link_regions() {
    count_pairs();
    neighbours_.clear();
    for (std::uint32_t r = 0; r < regions_.size(); ++r) {
        Region& region = regions_[r];
        region.first_neighbour = static_cast<std::uint32_t>(neighbours_.size());
        for (std::uint32_t l = first_link_[r]; l != kNoRegion; l = links_[l].next) {
            const Region& other = regions_[links_[l].to];
            const float nearness =
                static_cast<float>(other.num) *
                std::exp(-(other.centre - region.centre).squaredNorm() / kNearSq);
            neighbours_.push_back(
                {links_[l].to, static_cast<float>(links_[l].num_pairs), nearness});
        }
        std::sort(neighbours_.begin() + region.first_neighbour,
                  neighbours_.end(),
                  [](const Neighbour& a, const Neighbour& b) { return a.region < b.region; });
        region.num_neighbours =
            static_cast<std::uint32_t>(neighbours_.size()) - region.first_neighbour;
    }
}

void MotionEstimator::count_pairs() {
    touch_lattice_.fit(now_->bounds(), static_cast<double>(kTouchM));
    touch_begin_.assign(touch_lattice_.num_cells + 1, 0);
    placed_unsorted_.clear();
    for (std::uint32_t r = 0; r < regions_.size(); ++r) {
        for (std::uint32_t p = regions_[r].first; p < regions_[r].first + regions_[r].num; ++p) {
            Int4 cell = touch_lattice_.cell_at(now_->samples()[points_[p].sample].position);
            const std::size_t index = touch_lattice_.index_of(cell);
            cell[3] = static_cast<std::int32_t>(index);
            placed_unsorted_.push_back({cell, r});
            ++touch_begin_[index];
        }
    }
    std::uint32_t end = 0;
    for (std::uint32_t& begin : touch_begin_) begin = end += begin;
    placed_.resize(points_.size());
    for (std::vector<float>& column : placed_at_) column.resize(points_.size() + kFloat4Size);
    placed_region_.resize(points_.size() + kFloat4Size);
    // the points are in the order of their regions
    for (std::size_t p = points_.size(); p-- > 0;) {
        const Placed& placed = placed_unsorted_[p];
        const std::uint32_t at = --touch_begin_[static_cast<std::size_t>(placed.cell[3])];
        const Eigen::Vector3f& position = now_->samples()[points_[p].sample].position;
        for (std::size_t axis = 0; axis < 3; ++axis)
            placed_at_[axis][at] = position[static_cast<Eigen::Index>(axis)];
        placed_[at] = placed;
        placed_region_[at] = placed.region;
    }

    links_.clear();
    first_link_.assign(regions_.size(), kNoRegion);
    const auto link = [&](std::uint32_t from, std::uint32_t to) {
        links_.push_back({to, 1, first_link_[from]});
        first_link_[from] = static_cast<std::uint32_t>(links_.size() - 1);
    };
    const auto add_pair = [&](std::uint32_t a, std::uint32_t b) {
        for (std::uint32_t l = first_link_[a]; l != kNoRegion; l = links_[l].next) {
            if (links_[l].to != b) continue;
            ++links_[l].num_pairs;
            ++links_[l ^ 1U].num_pairs;  // the reverse link
            return;
        }
        link(a, b);
        link(b, a);
    };
    const Eigen::Array3i& dims = touch_lattice_.dims;
    constexpr std::array<std::array<int, 2>, 5> kRowsAfter{
        {{0, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}};
    // each pair once: of the rows of cells around a point, those after its own; in its own row, the
    // points after it
    for (std::uint32_t i = 0; i < placed_.size(); ++i) {
        const Placed& own = placed_[i];
        const Float4 x = all4(placed_at_[0][i]);
        const Float4 y = all4(placed_at_[1][i]);
        const Float4 z = all4(placed_at_[2][i]);
        const Int4 own_region = Int4{} + static_cast<std::int32_t>(own.region);
        const int from_x = std::max(0, own.cell[0] - 1);
        const int to_x = std::min(dims.x() - 1, own.cell[0] + 1);
        for (const auto& [dy, dz] : kRowsAfter) {
            const int row_y = own.cell[1] + dy;
            const int row_z = own.cell[2] + dz;
            if (row_y < 0 || row_y >= dims.y() || row_z >= dims.z()) continue;
            const std::uint32_t* row = touch_begin_.data() + (row_z * dims.y() + row_y) * dims.x();
            const bool is_own_row = dy == 0 && dz == 0;
            const std::uint32_t row_end = row[to_x + 1];
            for (std::uint32_t j = is_own_row ? i + 1 : row[from_x]; j < row_end;
                 j += kFloat4Size) {
                const Float4 off_x = load4(placed_at_[0].data() + j) - x;
                const Float4 off_y = load4(placed_at_[1].data() + j) - y;
                const Float4 off_z = load4(placed_at_[2].data() + j) - z;
                Int4 regions;
                std::memcpy(&regions, placed_region_.data() + j, sizeof regions);
                // most points are beside points of their own region
                unsigned bits =
                    bits_of((off_x * off_x + off_y * off_y + off_z * off_z < kTouchM * kTouchM) &
                            (regions != own_region));
                // beyond the end of the row are points of other rows
                if (row_end - j < kFloat4Size) bits &= (1U << (row_end - j)) - 1U;
                for (; bits != 0; bits &= bits - 1) {
                    const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
                    add_pair(own.region, placed_region_[j + lane]);
                }
            }
        }
    }
}

float MotionEstimator::mismatch(const SurfaceSample& sample,
                                const Eigen::Vector3f& displacement) const {
    const SurfaceSample place{sample.position - displacement, sample.normal};
    std::uint32_t found = SurfaceIndex::kNone;
    match(*before_, {&place, 1}, {&found, 1});
    return found == SurfaceIndex::kNone
               ? 1.0F
               : robust_cost(distance_along_normal(before_->samples()[found], place.position));
}

// Prepares `blend`: for each region the motion of itself and its neighbours, as a rotation and a
// constant.
void MotionEstimator::blend_regions() {
    blends_.clear();
    first_blend_.clear();
    may_differ_.clear();
    for (const Region& region : regions_) {
        first_blend_.push_back(static_cast<std::uint32_t>(blends_.size()));
        bool may_differ = false;
        const auto differs = [&](const Region& other) {
            return (other.displacement - region.displacement).squaredNorm() >
                   kIndifferentM * kIndifferentM;
        };
        const auto add = [&](const Region& other) {
            const Eigen::Vector3f constant = other.displacement - other.turn.cross(other.centre);
            Blend& blend = blends_.emplace_back();
            for (int axis = 0; axis < 3; ++axis) {
                const auto row = static_cast<std::size_t>(axis);
                blend.centre[row] = all4(other.centre[axis]);
                blend.turn[row] = all4(other.turn[axis]);
                blend.constant[row] = all4(constant[axis]);
            }
            blend.alike = all4(1.0F / unlike(other.displacement, region.displacement));
        };
        add(region);
        for (const Neighbour& n : neighbours_of(region)) {
            add(regions_[n.region]);
            may_differ = may_differ || differs(regions_[n.region]);
        }
        if (region.sibling != kNoRegion)
            may_differ = may_differ || differs(regions_[region.sibling]);
        may_differ_.push_back(may_differ ? 1 : 0);
    }
    first_blend_.push_back(static_cast<std::uint32_t>(blends_.size()));
}

// Blends the motion of a region's samples with adjacent regions that move alike.
void MotionEstimator::blend(std::uint32_t region,
                            std::span<const std::uint32_t> samples,
                            std::vector<Eigen::Vector3f>& displacements) const {
    const float per_sq = -2.0F / (region_lattice_.cell_m * region_lattice_.cell_m);
    const std::span<const Blend> blends(blends_.data() + first_blend_[region],
                                        blends_.data() + first_blend_[region + 1]);
    Eight eight{};
    for (std::size_t begin = 0; begin < samples.size(); begin += kFloat8Size) {
        const std::size_t num = std::min(kFloat8Size, samples.size() - begin);
        for (std::size_t lane = 0; lane < num; ++lane) {
            const Eigen::Vector3f& position = now_->samples()[samples[begin + lane]].position;
            for (std::size_t axis = 0; axis < 3; ++axis)
                eight[axis][lane] = position[static_cast<Eigen::Index>(axis)];
        }
#ifdef ATRIUM_AVX2
        if (__builtin_cpu_supports("avx2"))
            blend_eight_avx2(blends, per_sq, eight);
        else
#endif
            blend_eight(blends, per_sq, eight);
        for (std::size_t lane = 0; lane < num; ++lane) {
            Eigen::Vector3f& displacement = displacements[samples[begin + lane]];
            displacement = regions_[region].displacement;
            if (eight[3][lane] > 1e-6F)
                displacement = {eight[0][lane], eight[1][lane], eight[2][lane]};
        }
    }
}

// Like `blend`, for one sample in the cell of `own` that moves with `region`.
Eigen::Vector3f MotionEstimator::blended_as(const Region& own,
                                            const Region& region,
                                            const Eigen::Vector3f& position) const {
    const float region_m = region_lattice_.cell_m;
    float weights = 0.0F;
    Eigen::Vector3f blend = Eigen::Vector3f::Zero();
    const auto add = [&](const Region& other) {
        const float apart = (other.centre - position).squaredNorm() / (region_m * region_m);
        const float weight =
            std::exp(-2.0F * apart) / unlike(other.displacement, region.displacement);
        weights += weight;
        blend += weight * (other.displacement + other.turn.cross(position - other.centre));
    };
    add(region);
    for (const Neighbour& n : neighbours_of(own)) add(regions_[n.region]);
    return weights > 1e-6F ? (blend / weights).eval() : region.displacement;
}

std::uint32_t MotionEstimator::region_of(const Eigen::Vector3f& position) const {
    const Octant& octant = octants_[octant_lattice_.index_of(position)];
    const std::size_t slot = 2 * region_lattice_.index_of(position);
    const bool moves = octant.num == 0 || octant.moves();
    const std::uint32_t region = region_at_[slot + (moves ? 1 : 0)];
    if (region != kNoRegion) return region;
    const std::uint32_t sibling = region_at_[slot + (moves ? 0 : 1)];
    if (sibling != kNoRegion) return sibling;
    // the cell contains no matched point
    const auto nearest =
        std::min_element(regions_.begin(), regions_.end(), [&](const Region& a, const Region& b) {
            return (a.centre - position).squaredNorm() < (b.centre - position).squaredNorm();
        });
    return static_cast<std::uint32_t>(nearest - regions_.begin());
}

void MotionEstimator::sort_samples_by_region() {
    const auto samples = now_->samples();
    region_of_sample_.resize(samples.size());
    sorted_samples_.resize(samples.size());
    first_sample_.assign(regions_.size() + 1, 0);
    for (std::size_t i = 0; i < samples.size(); ++i)
        ++first_sample_[region_of_sample_[i] = region_of(samples[i].position)];
    std::uint32_t end = 0;
    for (std::uint32_t& first : first_sample_) first = end += first;
    for (std::size_t i = samples.size(); i-- > 0;)
        sorted_samples_[--first_sample_[region_of_sample_[i]]] = static_cast<std::uint32_t>(i);
}

void MotionEstimator::displace(std::vector<Eigen::Vector3f>& displacements) {
    for (std::uint32_t r = 0; r < regions_.size(); ++r) {
        const std::span<const std::uint32_t> samples(sorted_samples_.data() + first_sample_[r],
                                                     sorted_samples_.data() + first_sample_[r + 1]);
        blend(r, samples, displacements);
        if (may_differ_[r] == 0) continue;
        for (const std::uint32_t i : samples) {
            if (const auto other = displacement_of_another(regions_[r], now_->samples()[i]))
                displacements[i] = *other;
        }
    }
}

// A sample that its region does not explain, as where two parts meet, may belong to another region.
// A sample that no region explains keeps its region's motion.
std::optional<Eigen::Vector3f> MotionEstimator::displacement_of_another(
    const Region& own, const SurfaceSample& sample) const {
    if (mismatch(sample, own.displacement) <= kMismatch) return std::nullopt;
    const auto is_of = [&](const Region& candidate) {
        return mismatch(sample, candidate.displacement) < kMismatch;
    };
    if (own.sibling != kNoRegion && is_of(regions_[own.sibling]))
        return blended_as(own, regions_[own.sibling], sample.position);
    for (const Neighbour& n : neighbours_of(own)) {
        if (is_of(regions_[n.region])) return blended_as(own, regions_[n.region], sample.position);
    }
    return std::nullopt;
}

}  // namespace atrium::physics
