// Start values for a region's motion: rest, previous motion, votes, neighbours.
#include "world_server/physics/people/motion_match.hpp"
#include "world_server/physics/people/person_motion.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

using motion::cell_at;
using motion::is_explained_by;

float surprise(float off_m, std::size_t num_points, const MotionStartOptions& options) {
    const float full = std::min(1.0F, off_m / options.surprise_m);
    const float leap = std::clamp(2.0F * full - 1.0F, 0.0F, 1.0F);
    const float further = std::max(0.0F, off_m - options.surprise_m) / options.further_m;
    return options.surprise * (full + further) *
           (1.0F + leap * options.few_points / static_cast<float>(num_points));
}

}  // namespace

void MotionEstimator::start_from_rest(Region& region) {
    if (region.moves) {
        region.displacement = refine(region, Eigen::Vector3f::Zero(), 3);
        region.cost = correspond(region, region.displacement, options_.start.trial_points).cost;
    } else {
        const auto first = points_.begin() + region.first;
        const auto num_unexplained = std::count_if(
            first, first + region.num, [](const Point& p) { return !p.is_explained; });
        region.cost = static_cast<float>(num_unexplained) / static_cast<float>(region.num);
    }
    region.from_rest = region.displacement;
}

// A region at the predicted place of a previous region may continue its motion.
void MotionEstimator::start_from_before() {
    for (Region& region : regions_) {
        if (!region.moves) {
            // rest also explains a palm that slides along itself
            if (!region.predicted || region.predicted->norm() < options_.start.slides_m) continue;
            const float cost =
                correspond(region, *region.predicted, options_.start.trial_points).cost;
            const float at_rest =
                correspond(region, region.displacement, options_.start.trial_points).cost;
            if (cost <= at_rest + options_.start.no_worse) region.displacement = *region.predicted;
            continue;
        }
        for (const Moved& moved : previous_) {
            if (region.num_starts == kMaxPrevious) break;
            const Eigen::Vector3f headed = moved.centre + moved.displacement;
            if ((headed - region.centre).squaredNorm() >
                options_.start.previous_m * options_.start.previous_m)
                continue;
            const auto end = region.starts.begin() + static_cast<std::ptrdiff_t>(region.num_starts);
            const bool is_known =
                std::any_of(region.starts.begin(), end, [&](const Eigen::Vector3f& start) {
                    return (start - moved.displacement).norm() < 0.5F * options_.alike_m;
                });
            if (!is_known) region.starts[region.num_starts++] = moved.displacement;
        }
        region.num_expected = region.num_starts;
        choose_start(region, 0);
        region.is_hard = region.cost > options_.start.hard_cost;
    }
}

// Adjacent unexplained regions vote together.
void MotionEstimator::start_from_votes() {
    vanished_.clear();
    std::vector<bool> is_done(regions_.size(), false);
    std::vector<std::uint32_t> group;
    for (std::uint32_t seed = 0; seed < regions_.size(); ++seed) {
        if (!regions_[seed].is_hard || is_done[seed]) continue;
        group.assign(1, seed);
        is_done[seed] = true;
        for (std::size_t i = 0; i < group.size(); ++i) {
            for (const Neighbour& next : neighbours_of(regions_[group[i]])) {
                if (!regions_[next.region].is_hard || is_done[next.region]) continue;
                is_done[next.region] = true;
                group.push_back(next.region);
            }
        }
        vote(group);
    }
    for (Region& region : regions_) choose_start(region, region.num_expected);
}

void MotionEstimator::vote(std::span<const std::uint32_t> group) {
    if (vanished_.empty()) {
        const auto samples = before_->samples();
        const std::size_t stride = 1 + samples.size() / options_.max_points;
        places_.clear();
        for (std::size_t i = 0; i < samples.size(); i += stride) places_.push_back(samples[i]);
        match_places(*now_);
        for (std::size_t n = 0; n < places_.size(); ++n) {
            if (!is_explained_by(*now_, matched_[n], places_[n], options_.match.explained_m))
                vanished_.push_back(static_cast<std::uint32_t>(n * stride));
        }
    }
    const auto max_step_m = static_cast<float>(options_.max_step_m);
    const float bin_m = options_.start.bin_m;
    const float same_facing = options_.match.same_facing;
    const int half = static_cast<int>(std::ceil(max_step_m / bin_m));
    const int side = 2 * half + 2;
    votes_.assign(static_cast<std::size_t>(side) * side * side, 0);
    const auto index = [&](int x, int y, int z) {
        return static_cast<std::size_t>((z * side + y) * side + x);
    };
    std::size_t num_points = 0;
    for (const std::uint32_t r : group) num_points += regions_[r].num;
    const std::size_t stride = 1 + num_points / options_.start.max_voters;
    const std::size_t vanished_stride = 1 + vanished_.size() / (2 * options_.start.max_voters);
    std::size_t count = 0;
    Eigen::Array3i low = Eigen::Array3i::Constant(side);  // range of bins with votes
    Eigen::Array3i high = Eigen::Array3i::Constant(-1);
    for (const std::uint32_t r : group) {
        for (std::size_t i = 0; i < regions_[r].num; ++i) {
            const Point& point = points_[regions_[r].first + i];
            if (point.is_explained || count++ % stride != 0) continue;
            const SurfaceSample& sample = now_->samples()[point.sample];
            for (std::size_t v = 0; v < vanished_.size(); v += vanished_stride) {
                const SurfaceSample& from = before_->samples()[vanished_[v]];
                const Eigen::Vector3f step = sample.position - from.position;
                if (from.normal.dot(sample.normal) < same_facing ||
                    step.squaredNorm() > max_step_m * max_step_m) {
                    continue;
                }
                const Eigen::Array3i bin = cell_at(step, bin_m) + half;
                ++votes_[index(bin.x(), bin.y(), bin.z())];
                low = low.min(bin);
                high = high.max(bin);
            }
        }
    }
    low = (low - 1).max(0);
    high = high.min(side - 2);
    for (std::size_t peak = 0; peak < kNumPeaks; ++peak) {
        // blocks of two bins per side: no peak is cut by a bin border
        int best = 0;
        Eigen::Array3i best_bin = Eigen::Array3i::Zero();
        for (int z = low.z(); z <= high.z(); ++z) {
            for (int y = low.y(); y <= high.y(); ++y) {
                const auto column = [&](int x) {
                    return votes_[index(x, y, z)] + votes_[index(x, y + 1, z)] +
                           votes_[index(x, y, z + 1)] + votes_[index(x, y + 1, z + 1)];
                };
                int left = column(low.x());
                for (int x = low.x(); x <= high.x(); ++x) {
                    const int right = column(x + 1);
                    const int sum = left + right;
                    left = right;
                    if (sum <= best) continue;
                    best = sum;
                    best_bin = {x, y, z};
                }
            }
        }
        if (best == 0) return;
        const Eigen::Vector3f start = ((best_bin - half + 1).cast<float>() * bin_m).matrix();
        for (const std::uint32_t r : group) regions_[r].starts[regions_[r].num_starts++] = start;
        for (int i = 0; i < 8; ++i) {
            votes_[index(
                best_bin.x() + (i & 1), best_bin.y() + (i >> 1 & 1), best_bin.z() + (i >> 2))] = 0;
        }
    }
}

// Chooses among the starts from index `first`. A start from votes must explain more than an
// expected one: the more, the further away it is, because two hands look alike. A leap must explain
// more the fewer points it covers: some place always fits a newly visible speck of surface.
void MotionEstimator::choose_start(Region& region, std::size_t first) {
    float least = region.cost;
    for (std::size_t i = first; i < region.num_starts; ++i) {
        Eigen::Vector3f& start = region.starts[i];
        start = refine(region, start, 3);
        const float cost = correspond(region, start, options_.start.trial_points).cost;
        float surprise_m = 0.0F;
        if (i >= region.num_expected) {
            surprise_m = (start - region.from_rest).norm();
            for (std::size_t j = 0; j < region.num_expected; ++j) {
                surprise_m = std::min(surprise_m, (start - region.starts[j]).norm());
            }
        }
        const float total = cost + surprise(surprise_m, region.num, options_.start);
        if (total >= least) continue;
        least = total;
        region.cost = cost;
        region.displacement = start;
    }
}

// Lets neighbours decide where several displacements explain a region about equally well (a forearm
// along itself, a flat part).
void MotionEstimator::choose_with_neighbours() {
    // weighs more the fewer points a region has
    const auto disagreement = [&](const Region& region, const Eigen::Vector3f& displacement) {
        float sum = 0.0F;
        float weights = 0.0F;
        for (const Neighbour& n : neighbours_of(region)) {
            const float difference = (regions_[n.region].displacement - displacement).norm();
            sum += n.nearness * std::min(1.0F, difference / (2.0F * options_.alike_m));
            weights += n.nearness;
        }
        if (weights <= 0.0F) return 0.0F;
        return options_.start.agreement *
               (1.0F + options_.start.few_points / static_cast<float>(region.num)) * sum / weights;
    };
    for (int sweep = 0; sweep < 3; ++sweep) {
        bool has_changed = false;
        for (Region& region : regions_) {
            float best = region.cost + disagreement(region, region.displacement);
            for (const Neighbour& n : neighbours_of(region)) {
                const Eigen::Vector3f& theirs = regions_[n.region].displacement;
                if ((theirs - region.displacement).norm() < options_.alike_m) continue;
                const float disagreeing = disagreement(region, theirs);
                if (disagreeing >= best) continue;
                const float cost = correspond(region, theirs, options_.start.trial_points).cost;
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

}  // namespace atrium::physics
