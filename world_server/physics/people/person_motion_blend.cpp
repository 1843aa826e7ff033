// Blends the motion of adjacent regions over their samples.
#include "world_server/physics/people/float8.hpp"
#include "world_server/physics/people/motion_match.hpp"
#include "world_server/physics/people/person_motion.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::physics {
namespace {

float unlike(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float alike_m) {
    const float ratio = (a - b).squaredNorm() / (alike_m * alike_m);
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

float MotionEstimator::mismatch(const SurfaceSample& sample,
                                const Eigen::Vector3f& displacement) const {
    const SurfaceSample place{sample.position - displacement, sample.normal};
    std::uint32_t found = SurfaceIndex::kNone;
    motion::match(*before_, {&place, 1}, options_.match, {&found, 1});
    return found == SurfaceIndex::kNone
               ? 1.0F
               : motion::robust_cost(
                     motion::distance_along_normal(before_->samples()[found], place.position),
                     options_.match.scale_m);
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
                   options_.indifferent_m * options_.indifferent_m;
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
            blend.alike =
                all4(1.0F / unlike(other.displacement, region.displacement, options_.alike_m));
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
        const float weight = std::exp(-2.0F * apart) /
                             unlike(other.displacement, region.displacement, options_.alike_m);
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
    const bool moves = octant.num == 0 || octant.moves(options_.moving_share);
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
    if (mismatch(sample, own.displacement) <= options_.mismatch) return std::nullopt;
    const auto is_of = [&](const Region& candidate) {
        return mismatch(sample, candidate.displacement) < options_.mismatch;
    };
    if (own.sibling != kNoRegion && is_of(regions_[own.sibling]))
        return blended_as(own, regions_[own.sibling], sample.position);
    for (const Neighbour& n : neighbours_of(own)) {
        if (is_of(regions_[n.region])) return blended_as(own, regions_[n.region], sample.position);
    }
    return std::nullopt;
}

}  // namespace atrium::physics
