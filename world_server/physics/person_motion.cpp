#include "world_server/physics/person_motion.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::physics {
namespace {

constexpr float kSameFacing = 0.6F;    // cosine
constexpr float kSearchM = 0.05F;      // around the place that a displacement gives
constexpr float kExplainedM = 0.012F;  // along the normal: closer than this, rest explains a point
constexpr float kScaleM = 0.012F;      // of the robust cost
constexpr float kHardCost = 0.2F;      // above, rest does not explain a region
constexpr float kNeighbourM = 0.21F;   // between the centres of regions that are coupled
constexpr float kAlikeM = 0.05F;       // difference of displacement of parts that move together
constexpr float kDamping = 0.02F;      // pull towards the start, in points' worth per point
constexpr float kCoupling = 0.08F;     // of a neighbour, in points' worth per point
constexpr float kAgreement = 0.15F;    // cost of disagreeing with all neighbours
constexpr float kPreviousM = 0.15F;    // off where it was headed, a place is another
constexpr std::size_t kMaxPrevious = 3;  // starts from what regions did before
constexpr int kNumPeaks = 4;             // starts from votes
constexpr float kBinM = 0.04F;           // of the votes
constexpr std::size_t kMaxVoters = 200;
constexpr std::size_t kTrialPoints = 24;  // of a region that a start is tried on

std::uint64_t pack(const Eigen::Array3i& cell, bool moves) {
    const auto part = [](int x) { return static_cast<std::uint64_t>(x + (1 << 19)) & 0xFFFFFU; };
    return part(cell.z()) << 41U | part(cell.y()) << 21U | part(cell.x()) << 1U | (moves ? 1U : 0U);
}

Eigen::Array3i cell_at(const Eigen::Vector3f& position, float cell_m) {
    return (position / cell_m).array().floor().cast<int>();
}

float robust_cost(float distance_m) {
    const float sq = distance_m * distance_m;
    return sq / (sq + kScaleM * kScaleM);
}

std::optional<SurfaceSample> match(const SurfaceIndex& surface,
                                   const Eigen::Vector3f& place,
                                   const Eigen::Vector3f& normal) {
    return surface.nearest(place, kSearchM, [&](const SurfaceSample& candidate) {
        return candidate.normal.dot(normal) > kSameFacing;
    });
}

bool is_explained_by(const SurfaceIndex& surface, const SurfaceSample& sample) {
    const auto found = match(surface, sample.position, sample.normal);
    return found && std::abs(found->normal.dot(sample.position - found->position)) < kExplainedM;
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
// octants of which at least a third is not explained by rest are a region of their own.
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
    for (auto begin = points_.begin(); begin != points_.end();) {
        const auto end =
            std::find_if(begin, points_.end(), [&](const Point& p) { return p.key != begin->key; });
        const auto num_unexplained =
            std::count_if(begin, end, [](const Point& p) { return !p.is_explained; });
        const bool moves = 3 * num_unexplained >= end - begin;
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

void MotionEstimator::start_from_rest(Region& region) {
    const bool moves = (region.key & 1U) != 0;
    region.displacement =
        moves ? refine(region, Eigen::Vector3f::Zero(), 3) : Eigen::Vector3f::Zero().eval();
    region.cost = moves ? correspond(region, region.displacement, kTrialPoints).cost : 0.0F;
    region.is_hard = region.cost > kHardCost;
}

// What lies where a region of the mesh before was headed may go on as that did.
void MotionEstimator::add_previous_starts() {
    for (Region& region : regions_) {
        if ((region.key & 1U) == 0) continue;
        for (const Moved& moved : previous_) {
            if (region.starts.size() == kMaxPrevious) break;
            const Eigen::Vector3f headed = moved.centre + moved.displacement;
            if ((headed - region.centre).squaredNorm() > kPreviousM * kPreviousM) continue;
            const bool is_known = std::any_of(
                region.starts.begin(), region.starts.end(), [&](const Eigen::Vector3f& start) {
                    return (start - moved.displacement).norm() < 0.5F * kAlikeM;
                });
            if (!is_known) region.starts.push_back(moved.displacement);
        }
    }
}

// Regions that rest does not explain vote together where they touch.
void MotionEstimator::add_voted_starts() {
    vanished_.clear();
    std::vector<bool> is_done(regions_.size(), false);
    std::vector<std::uint32_t> group;
    for (std::uint32_t seed = 0; seed < regions_.size(); ++seed) {
        if (!regions_[seed].is_hard || is_done[seed]) continue;
        group.assign(1, seed);
        is_done[seed] = true;
        for (std::size_t i = 0; i < group.size(); ++i) {
            for (const std::uint32_t next : regions_[group[i]].neighbours) {
                if (!regions_[next].is_hard || is_done[next]) continue;
                is_done[next] = true;
                group.push_back(next);
            }
        }
        vote(group);
    }
}

void MotionEstimator::vote(std::span<const std::uint32_t> group) {
    if (vanished_.empty()) {
        const auto samples = before_->samples();
        const std::size_t stride = 1 + samples.size() / options_.max_points;
        for (std::size_t i = 0; i < samples.size(); i += stride) {
            if (!is_explained_by(*now_, samples[i])) {
                vanished_.push_back(static_cast<std::uint32_t>(i));
            }
        }
    }
    const auto max_step_m = static_cast<float>(options_.max_step_m);
    const int half = static_cast<int>(std::ceil(max_step_m / kBinM));
    const int side = 2 * half + 2;
    votes_.assign(static_cast<std::size_t>(side) * side * side, 0);
    const auto index = [&](int x, int y, int z) {
        return static_cast<std::size_t>((z * side + y) * side + x);
    };
    std::size_t num_points = 0;
    for (const std::uint32_t r : group) num_points += regions_[r].num;
    const std::size_t stride = 1 + num_points / kMaxVoters;
    const std::size_t vanished_stride = 1 + vanished_.size() / (2 * kMaxVoters);
    std::size_t count = 0;
    for (const std::uint32_t r : group) {
        for (std::size_t i = 0; i < regions_[r].num; ++i) {
            const Point& point = points_[regions_[r].first + i];
            if (point.is_explained || count++ % stride != 0) continue;
            const SurfaceSample& sample = now_->samples()[point.sample];
            for (std::size_t v = 0; v < vanished_.size(); v += vanished_stride) {
                const SurfaceSample& from = before_->samples()[vanished_[v]];
                const Eigen::Vector3f step = sample.position - from.position;
                if (from.normal.dot(sample.normal) < kSameFacing ||
                    step.squaredNorm() > max_step_m * max_step_m) {
                    continue;
                }
                const Eigen::Array3i bin = cell_at(step, kBinM) + half;
                ++votes_[index(bin.x(), bin.y(), bin.z())];
            }
        }
    }
    for (int peak = 0; peak < kNumPeaks; ++peak) {
        // blocks of two bins a side, so that no true peak is cut by a border
        int best = 0;
        Eigen::Array3i best_bin = Eigen::Array3i::Zero();
        for (int z = 0; z + 1 < side; ++z) {
            for (int y = 0; y + 1 < side; ++y) {
                for (int x = 0; x + 1 < side; ++x) {
                    const int sum = votes_[index(x, y, z)] + votes_[index(x + 1, y, z)] +
                                    votes_[index(x, y + 1, z)] + votes_[index(x + 1, y + 1, z)] +
                                    votes_[index(x, y, z + 1)] + votes_[index(x + 1, y, z + 1)] +
                                    votes_[index(x, y + 1, z + 1)] +
                                    votes_[index(x + 1, y + 1, z + 1)];
                    if (sum <= best) continue;
                    best = sum;
                    best_bin = {x, y, z};
                }
            }
        }
        if (best == 0) return;
        const Eigen::Vector3f start = ((best_bin - half + 1).cast<float>() * kBinM).matrix();
        for (const std::uint32_t r : group) regions_[r].starts.push_back(start);
        for (int i = 0; i < 8; ++i) {
            votes_[index(
                best_bin.x() + (i & 1), best_bin.y() + (i >> 1 & 1), best_bin.z() + (i >> 2))] = 0;
        }
    }
}

void MotionEstimator::choose_starts() {
    for (Region& region : regions_) {
        for (Eigen::Vector3f& start : region.starts) {
            start = refine(region, start, 3);
            const float cost = correspond(region, start, kTrialPoints).cost;
            if (cost >= region.cost) continue;
            region.cost = cost;
            region.displacement = start;
        }
    }
}

// Where several displacements explain a region about as well (a forearm along itself, a flat part),
// its neighbours decide.
void MotionEstimator::choose_with_neighbours() {
    const auto disagreement = [&](const Region& region, const Eigen::Vector3f& displacement) {
        if (region.neighbours.empty()) return 0.0F;
        float sum = 0.0F;
        for (const std::uint32_t n : region.neighbours) {
            const float difference = (regions_[n].displacement - displacement).norm();
            sum += std::min(1.0F, difference / (2.0F * kAlikeM));
        }
        return kAgreement * sum / static_cast<float>(region.neighbours.size());
    };
    for (int sweep = 0; sweep < 3; ++sweep) {
        bool has_changed = false;
        for (Region& region : regions_) {
            float best = region.cost + disagreement(region, region.displacement);
            for (const std::uint32_t n : region.neighbours) {
                const Eigen::Vector3f& theirs = regions_[n].displacement;
                if ((theirs - region.displacement).norm() < kAlikeM) continue;
                const float disagreeing = disagreement(region, theirs);
                if (disagreeing >= best) continue;
                const float cost = correspond(region, theirs, kTrialPoints).cost;
                if (cost + disagreeing >= best) continue;
                best = cost + disagreeing;
                region.cost = cost;
                region.displacement = theirs;
                has_changed = true;
            }
        }
        if (!has_changed) return;
    }
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
    const Region* region = find(false);
    const Region* moving = find(true);
    if (region == nullptr) region = moving;
    if (region == nullptr) return Eigen::Vector3f::Zero();
    if (moving != nullptr && moving != region &&
        mismatch(sample, moving->displacement) < mismatch(sample, region->displacement)) {
        region = moving;
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
