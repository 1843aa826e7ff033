#include "world_server/physics/person_motion.hpp"

#include "world_server/physics/motion_match.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace atrium::physics {
namespace {

using motion::cell_at;
using motion::is_explained_by;
using motion::kAlikeM;
using motion::match;
using motion::robust_cost;

constexpr float kMovingShare = 0.12F;  // of an octant's points that rest does not explain
constexpr float kTouchM = 0.06F;       // between points of regions that are neighbours
constexpr float kMismatch = 0.6F;      // cost above which a sample is not of its region

std::uint64_t pack(const Eigen::Array3i& cell, bool moves) {
    const auto part = [](int x) { return static_cast<std::uint64_t>(x + (1 << 19)) & 0xFFFFFU; };
    return part(cell.z()) << 41U | part(cell.y()) << 21U | part(cell.x()) << 1U | (moves ? 1U : 0U);
}

}  // namespace

MotionEstimator::MotionEstimator(const MotionOptions& options) : options_(options) {
    assert(options.region_m > 0.0 && options.max_points > 0);
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
    for (Region& region : regions_) start_from_rest(region);
    start_from_before();
    start_from_votes();
    choose_with_neighbours();
    solve_together();
    for (std::size_t i = 0; i < displacements.size(); ++i) displacements[i] = displacement_at(i);
    previous_.clear();
    for (const Region& region : regions_) {
        previous_.push_back({region.centre, region.displacement, region.turn});
    }
}

// Regions are the lattice's cells, cut in two where only a part of a cell has left its place: the
// octants of which rest leaves a good part unexplained are a region of their own.
void MotionEstimator::make_regions() {
    const auto samples = now_->samples();
    const auto region_m = static_cast<float>(options_.region_m);
    // samples lie ordered by place, so that every n-th of them still covers every region
    const std::size_t stride = 1 + samples.size() / options_.max_points;
    points_.clear();
    for (std::size_t i = 0; i < samples.size(); i += stride) {
        points_.push_back({pack(cell_at(samples[i].position, 0.5F * region_m), false),
                           static_cast<std::uint32_t>(i),
                           is_explained_by(*before_, samples[i])});
    }
    const auto by_key = [](const Point& a, const Point& b) {
        return a.key != b.key ? a.key < b.key : a.sample < b.sample;
    };
    std::sort(points_.begin(), points_.end(), by_key);
    octants_.clear();
    for (auto begin = points_.begin(); begin != points_.end();) {
        const auto end =
            std::find_if(begin, points_.end(), [&](const Point& p) { return p.key != begin->key; });
        const auto num_unexplained =
            std::count_if(begin, end, [](const Point& p) { return !p.is_explained; });
        const bool moves =
            static_cast<float>(num_unexplained) > kMovingShare * static_cast<float>(end - begin);
        octants_.push_back({begin->key, moves});
        for (auto p = begin; p != end; ++p) {
            p->key = pack(cell_at(samples[p->sample].position, region_m), moves);
        }
        begin = end;
    }
    std::sort(points_.begin(), points_.end(), by_key);
    regions_.clear();
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
        if (i == 0 || points_[i].key != points_[i - 1].key) {
            regions_.emplace_back();
            regions_.back().key = points_[i].key;
            regions_.back().first = i;
        }
        ++regions_.back().num;
        regions_.back().centre += samples[points_[i].sample].position;
    }
    for (Region& region : regions_) region.centre /= static_cast<float>(region.num);
}

// Regions are neighbours where points of them lie side by side, and the more so the more such pairs
// there are: a hand before the chest is no neighbour of it.
void MotionEstimator::link_regions() {
    struct Placed {
        std::uint64_t cell;
        std::uint32_t point;
        std::uint32_t region;
    };
    const auto position = [&](std::uint32_t point) -> const Eigen::Vector3f& {
        return now_->samples()[points_[point].sample].position;
    };
    std::vector<Placed> placed;
    placed.reserve(points_.size());
    for (std::uint32_t r = 0; r < regions_.size(); ++r) {
        for (std::uint32_t p = regions_[r].first; p < regions_[r].first + regions_[r].num; ++p) {
            placed.push_back({pack(cell_at(position(p), kTouchM), false), p, r});
        }
    }
    std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
        return a.cell != b.cell ? a.cell < b.cell : a.point < b.point;
    });
    std::vector<std::uint64_t> pairs;  // of regions, one for each pair of points
    for (const Placed& own : placed) {
        const Eigen::Array3i cell = cell_at(position(own.point), kTouchM);
        for (int row = 0; row < 9; ++row) {
            const Eigen::Array3i first = cell + Eigen::Array3i(-1, row % 3 - 1, row / 3 - 1);
            const std::uint64_t last = pack(first + Eigen::Array3i(2, 0, 0), false);
            auto other = std::lower_bound(
                placed.begin(),
                placed.end(),
                pack(first, false),
                [](const Placed& candidate, std::uint64_t key) { return candidate.cell < key; });
            for (; other != placed.end() && other->cell <= last; ++other) {
                if (other->region <= own.region) continue;
                if ((position(other->point) - position(own.point)).squaredNorm() <
                    kTouchM * kTouchM) {
                    pairs.push_back(std::uint64_t{own.region} << 32U | other->region);
                }
            }
        }
    }
    std::sort(pairs.begin(), pairs.end());
    for (auto begin = pairs.begin(); begin != pairs.end();) {
        const auto end = std::upper_bound(begin, pairs.end(), *begin);
        const auto a = static_cast<std::uint32_t>(*begin >> 32U);
        const auto b = static_cast<std::uint32_t>(*begin);
        const auto num_pairs = static_cast<float>(end - begin);
        regions_[a].neighbours.push_back({b, num_pairs});
        regions_[b].neighbours.push_back({a, num_pairs});
        begin = end;
    }
}

float MotionEstimator::mismatch(const SurfaceSample& sample,
                                const Eigen::Vector3f& displacement) const {
    const Eigen::Vector3f place = sample.position - displacement;
    const auto found = match(*before_, place, sample.normal);
    return found ? robust_cost(found->normal.dot(place - found->position)) : 1.0F;
}

Eigen::Vector3f MotionEstimator::displacement_at(std::size_t index) const {
    const SurfaceSample& sample = now_->samples()[index];
    const auto region_m = static_cast<float>(options_.region_m);
    const auto find = [&](bool moves) -> const Region* {
        const std::uint64_t key = pack(cell_at(sample.position, region_m), moves);
        const auto found = std::lower_bound(
            regions_.begin(), regions_.end(), key, [](const Region& region, std::uint64_t k) {
                return region.key < k;
            });
        return found != regions_.end() && found->key == key ? &*found : nullptr;
    };
    const std::uint64_t octant_key = pack(cell_at(sample.position, 0.5F * region_m), false);
    const auto octant = std::lower_bound(
        octants_.begin(), octants_.end(), octant_key, [](const Octant& o, std::uint64_t key) {
            return o.key < key;
        });
    const bool moves = octant == octants_.end() || octant->key != octant_key || octant->moves;
    const Region* own = find(moves);
    const Region* sibling = find(!moves);
    if (own == nullptr) std::swap(own, sibling);
    if (own == nullptr) {  // none of the points looked up is in its cell
        own = &*std::min_element(
            regions_.begin(), regions_.end(), [&](const Region& a, const Region& b) {
                return (a.centre - sample.position).squaredNorm() <
                       (b.centre - sample.position).squaredNorm();
            });
    }
    // a sample that its region does not explain, as where two parts meet, may be of another; what
    // none explains moves with its region
    const Region* region = own;
    if (mismatch(sample, own->displacement) > kMismatch) {
        const auto is_of = [&](const Region& candidate) {
            return mismatch(sample, candidate.displacement) < kMismatch;
        };
        const auto beside =
            std::find_if(own->neighbours.begin(), own->neighbours.end(), [&](const Neighbour& n) {
                return is_of(regions_[n.region]);
            });
        if (sibling != nullptr && is_of(*sibling)) {
            region = sibling;
        } else if (beside != own->neighbours.end()) {
            region = &regions_[beside->region];
        }
    }
    // blend over into what moves alike beside it
    float weights = 0.0F;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    const auto add = [&](const Region& other) {
        const float apart = (other.centre - sample.position).squaredNorm() / (region_m * region_m);
        const float unlike =
            (other.displacement - region->displacement).squaredNorm() / (kAlikeM * kAlikeM);
        const float weight = std::exp(-2.0F * apart) / (1.0F + unlike * unlike);
        weights += weight;
        sum += weight * (other.displacement + other.turn.cross(sample.position - other.centre));
    };
    add(*region);
    for (const Neighbour& n : region->neighbours) add(regions_[n.region]);
    return weights > 1e-6F ? (sum / weights).eval() : region->displacement;
}

}  // namespace atrium::physics
