#include "world_server/physics/person_motion.hpp"

#include "world_server/physics/motion_match.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace atrium::physics {
namespace {

using motion::cell_at;
using motion::is_explained_by;
using motion::kAlikeM;
using motion::kTrialPoints;
using motion::match;

constexpr float kScaleM = 0.012F;      // of the robust cost
constexpr float kMovingShare = 0.12F;  // of an octant's points that rest does not explain
constexpr float kNeighbourM = 0.21F;   // between the centres of regions that are coupled
constexpr float kDamping = 0.02F;      // pull towards the start, in points' worth per point
constexpr float kCoupling = 0.08F;     // of a neighbour, in points' worth per point
constexpr float kMismatch = 0.6F;      // cost above which a sample is not of its region

std::uint64_t pack(const Eigen::Array3i& cell, bool moves) {
    const auto part = [](int x) { return static_cast<std::uint64_t>(x + (1 << 19)) & 0xFFFFFU; };
    return part(cell.z()) << 41U | part(cell.y()) << 21U | part(cell.x()) << 1U | (moves ? 1U : 0U);
}

float robust_cost(float distance_m) {
    const float sq = distance_m * distance_m;
    return sq / (sq + kScaleM * kScaleM);
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
    add_previous_starts();
    add_voted_starts();
    choose_starts();
    choose_with_neighbours();
    solve_together();
    for (std::size_t i = 0; i < displacements.size(); ++i) displacements[i] = displacement_at(i);
    previous_.clear();
    for (const Region& region : regions_) {
        previous_.push_back({region.centre, region.displacement});
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

void MotionEstimator::link_regions() {
    for (std::uint32_t i = 0; i < regions_.size(); ++i) {
        for (std::uint32_t j = i + 1; j < regions_.size(); ++j) {
            if ((regions_[i].centre - regions_[j].centre).squaredNorm() >
                kNeighbourM * kNeighbourM) {
                continue;
            }
            regions_[i].neighbours.push_back(j);
            regions_[j].neighbours.push_back(i);
        }
    }
}

MotionEstimator::Normals MotionEstimator::correspond(const Region& region,
                                                     const Eigen::Vector3f& displacement,
                                                     std::size_t max_points) const {
    Normals sum;
    const std::size_t stride = 1 + (region.num - 1) / max_points;
    float num = 0.0F;
    for (std::size_t i = 0; i < region.num; i += stride) {
        const SurfaceSample& sample = now_->samples()[points_[region.first + i].sample];
        const Eigen::Vector3f place = sample.position - displacement;
        num += 1.0F;
        const auto found = match(*before_, place, sample.normal);
        if (!found) {
            sum.cost += 1.0F;
            continue;
        }
        const Eigen::Vector3f& normal = found->normal;
        const float distance_m = normal.dot(place - found->position);
        const float cost = robust_cost(distance_m);
        const float weight = (1.0F - cost) + 0.05F;  // what fits badly may yet pull a little
        sum.cost += cost;
        sum.lhs += weight * normal * normal.transpose();
        sum.rhs += weight * distance_m * normal;
        sum.weight += weight;
    }
    sum.cost /= num;
    return sum;
}

Eigen::Vector3f MotionEstimator::refine(const Region& region,
                                        Eigen::Vector3f displacement,
                                        int rounds) const {
    for (int round = 0; round < rounds; ++round) {
        Normals sum = correspond(region, displacement, kTrialPoints);
        if (sum.weight <= 0.0F) break;
        sum.lhs.diagonal().array() += kDamping * sum.weight;
        displacement += sum.lhs.llt().solve(sum.rhs);
    }
    return displacement;
}

void MotionEstimator::solve_together() {
    normals_.resize(regions_.size());
    std::vector<Eigen::Vector3f> solution(regions_.size());
    for (int round = 0; round < 3; ++round) {
        for (std::size_t i = 0; i < regions_.size(); ++i) {
            normals_[i] = correspond(regions_[i], regions_[i].displacement);
            solution[i] = regions_[i].displacement;
        }
        for (int sweep = 0; sweep < 12; ++sweep) {
            for (std::size_t i = 0; i < regions_.size(); ++i) {
                const Region& region = regions_[i];
                // in terms of the whole displacement rather than the step
                Eigen::Matrix3f lhs = normals_[i].lhs;
                Eigen::Vector3f rhs = normals_[i].rhs + lhs * region.displacement;
                const float damping = kDamping * 0.1F * (normals_[i].weight + 0.1F);
                lhs.diagonal().array() += damping;
                rhs += damping * region.displacement;
                for (const std::uint32_t n : region.neighbours) {
                    const float difference = (solution[n] - solution[i]).squaredNorm();
                    const float weight = kCoupling * (normals_[i].weight + 0.1F) /
                                         (1.0F + difference / (kAlikeM * kAlikeM));
                    lhs.diagonal().array() += weight;
                    rhs += weight * solution[n];
                }
                solution[i] = lhs.llt().solve(rhs);
            }
        }
        const auto max_step_m = static_cast<float>(options_.max_step_m);
        for (std::size_t i = 0; i < regions_.size(); ++i) {
            const float step_m = solution[i].norm();
            if (!std::isfinite(step_m)) continue;
            if (step_m > max_step_m) solution[i] *= max_step_m / step_m;
            regions_[i].displacement = solution[i];
            regions_[i].cost = normals_[i].cost;
        }
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
        const auto beside = std::find_if(own->neighbours.begin(),
                                         own->neighbours.end(),
                                         [&](std::uint32_t n) { return is_of(regions_[n]); });
        if (sibling != nullptr && is_of(*sibling)) {
            region = sibling;
        } else if (beside != own->neighbours.end()) {
            region = &regions_[*beside];
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
        sum += weight * other.displacement;
    };
    add(*region);
    for (const std::uint32_t n : region->neighbours) add(regions_[n]);
    return weights > 1e-6F ? (sum / weights).eval() : region->displacement;
}

}  // namespace atrium::physics
