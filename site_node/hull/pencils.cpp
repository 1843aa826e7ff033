#include "site_node/hull/pencils.hpp"

#include "site_node/hull/rounding.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::hull {
namespace {

using Entry = Pencils::Entry;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// Antipodal directions differ by exactly 2, a full turn is 4; grows with the angle.
double pseudo_angle(const Eigen::Vector2d& v) {
    const double sum = std::abs(v.x()) + std::abs(v.y());
    if (sum == 0.0) return 0.0;
    const double p = v.x() / sum;
    return v.y() < 0.0 ? p - 1.0 : 1.0 - p;
}

// Orders rays of the two cameras of a pair by their angle around the baseline, in (-pi, pi] from a
// coordinate axis across it.
class AngularOrder {
public:
    AngularOrder(const Cones& cones, std::uint32_t i, std::uint32_t k)
        : cones_(cones),
          exact_baseline_(cones.exact_baseline(i, k)),
          baseline_(cones.views[k].centre - cones.views[i].centre) {
        int least = 0;
        baseline_.cwiseAbs().minCoeff(&least);
        zero_[static_cast<std::size_t>(least)] = 1;
        const Eigen::Vector3d axis = baseline_.normalized();
        e1_ = (Eigen::Vector3d::Unit(least) - axis[least] * axis).normalized();
        e2_ = axis.cross(e1_);
    }

    const Eigen::Vector3d& baseline() const { return baseline_; }
    const exact::Vector& exact_baseline() const { return exact_baseline_; }
    Eigen::Vector2d across(const Eigen::Vector3d& ray) const {
        return {e1_.dot(ray), e2_.dot(ray)};
    }
    Entry entry(std::uint32_t ray, const Eigen::Vector2d& across) const {
        const double length = std::abs(across.x()) + std::abs(across.y());
        const double error = 16.0 * kRounding * cones_.ray_length[ray];
        return {pseudo_angle(across), 2.0 * error < length ? error / length : 4.0, ray};
    }
    bool is_before(const Entry& l, const Entry& r) {
        const double difference = r.angle - l.angle;
        // near the ends of the interval a rounded angle may have come out at the other end
        const double error = l.error + r.error;
        const double extent = std::max(std::abs(l.angle), std::abs(r.angle));
        if (std::abs(difference) > error && extent < 2.0 - error && !cones_.only_exact)
            return difference > 0.0;
        return is_before_exactly(l.ray, r.ray);
    }
    bool is_degenerate() const { return is_degenerate_; }

private:
    // 0: at the start of the interval, below; 1: on the zero axis or above
    int half(const exact::Vector& ray) {
        const int side = exact::sign_of_determinant(exact_baseline_, zero_, ray);
        is_degenerate_ |= side == 0;
        return side > 0 ? 1 : 0;
    }
    bool is_before_exactly(std::uint32_t l, std::uint32_t r) {
        if (l == r) return false;
        const exact::Vector& a = cones_.exact_ray[l];
        const exact::Vector& b = cones_.exact_ray[r];
        const int half_a = half(a);
        const int half_b = half(b);
        if (half_a != half_b) return half_a < half_b;
        const int turn = exact::sign_of_determinant(exact_baseline_, a, b);
        is_degenerate_ |= turn == 0;
        return turn > 0;
    }

    const Cones& cones_;
    exact::Vector exact_baseline_;
    exact::Vector zero_{};
    Eigen::Vector3d baseline_;
    Eigen::Vector3d e1_;
    Eigen::Vector3d e2_;
    bool is_degenerate_ = false;
};

void sort_rays(const Cones& cones,
               const Cones::View& view,
               AngularOrder& order,
               std::vector<Entry>& entries,
               PencilSide& side) {
    const std::uint32_t n = view.last_ray - view.first_ray;
    side.across.resize(n);
    side.sorted.resize(n);
    side.position.resize(n);
    side.rank.resize(n);
    entries.clear();
    for (std::uint32_t j = 0; j < n; ++j) {
        side.across[j] = order.across(cones.ray[view.first_ray + j]);
        entries.push_back(order.entry(view.first_ray + j, side.across[j]));
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& l, const Entry& r) {
        return l.angle != r.angle ? l.angle < r.angle : l.ray < r.ray;
    });
    // the order is almost right; insertion makes it so
    for (std::size_t at = 1; at < entries.size(); ++at) {
        for (std::size_t to = at; to > 0 && order.is_before(entries[to], entries[to - 1]); --to)
            std::swap(entries[to], entries[to - 1]);
    }
    for (std::uint32_t at = 0; at < n; ++at) {
        side.sorted[at] = entries[at].ray - view.first_ray;
        side.position[side.sorted[at]] = at;
    }
}

// Ranks of both sides by one merge.
void merge_ranks(AngularOrder& order,
                 const Cones::View& first_view,
                 const std::vector<Entry>& first_entries,
                 PencilSide& first,
                 const Cones::View& second_view,
                 const std::vector<Entry>& second_entries,
                 PencilSide& second) {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    const auto na = static_cast<std::uint32_t>(first_entries.size());
    const auto nb = static_cast<std::uint32_t>(second_entries.size());
    while (a < na || b < nb) {
        const bool take_first =
            b == nb || (a < na && order.is_before(first_entries[a], second_entries[b]));
        if (take_first) {
            first.rank[first_entries[a++].ray - first_view.first_ray] = b;
        } else {
            second.rank[second_entries[b++].ray - second_view.first_ray] = a;
        }
    }
}

// `baseline`: from this centre to the other. `sense`: 1 if angles grow the right-handed way around
// it, -1 if the left-handed. False: a strip's plane contains the baseline.
bool place_strips(const Cones& cones,
                  const Cones::View& view,
                  const Eigen::Vector3d& baseline,
                  const exact::Vector& exact_baseline,
                  int sense,
                  PencilSide& side) {
    const std::uint32_t n = view.last_strip - view.first_strip;
    side.offset.resize(n);
    side.rises.resize(n);
    side.end_positions.resize(n);
    side.is_upper_end.assign(view.last_ray - view.first_ray, 0);
    const double error_scale = 10.0 * kRounding * baseline.norm();
    for (std::uint32_t s = 0; s < n; ++s) {
        const std::uint32_t strip = view.first_strip + s;
        const std::uint32_t from = cones.strips[strip].from;
        const std::uint32_t to = cones.strips[strip].to;
        const double offset = cones.normal[strip].dot(baseline);
        const double error = error_scale * cones.normal_bound[strip];
        const bool is_certain = std::abs(offset) > error;
        side.offset[s] = {is_certain ? 1.0 / offset : 0.0,
                          is_certain ? 1.0 / (std::abs(offset) - error) : kUnbounded,
                          error,
                          10.0 * kRounding * cones.normal_bound[strip]};
        // normal = to x from, so baseline . (from x to) is the offset's negative
        int turn = offset > 0.0 ? -1 : 1;
        if (!is_certain || cones.only_exact) {
            turn = exact::sign_of_determinant(
                exact_baseline, cones.exact_ray[from], cones.exact_ray[to]);
        }
        if (turn == 0) return false;
        const bool rises = turn == sense;
        side.rises[s] = rises;
        const std::uint32_t begin = side.position[from - view.first_ray];
        const std::uint32_t end = side.position[to - view.first_ray];
        side.end_positions[s] = {rises ? begin : end, rises ? end : begin};
        const std::uint32_t upper = rises ? to : from;
        const auto& incident = cones.incidence[upper].strips;
        const auto j = std::find(incident.begin(), incident.end(), strip) - incident.begin();
        side.is_upper_end[upper - view.first_ray] |= static_cast<std::uint8_t>(1u << j);
    }
    return true;
}

}  // namespace

bool build_pencils(const Cones& cones, Executor& executor, Pencils& pencils) {
    const std::size_t n = cones.num_views();
    pencils.num_views = n;
    if (pencils.sides.size() < n * n) pencils.sides.resize(n * n);
    if (pencils.sort_buffers.size() < executor.num_workers())
        pencils.sort_buffers.resize(executor.num_workers());
    pencils.pairs.clear();
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t k = i + 1; k < n; ++k) pencils.pairs.emplace_back(i, k);
    }
    pencils.is_degenerate.assign(pencils.pairs.size(), 0);
    const auto build_pair = [&](std::size_t task, std::size_t worker) {
        const auto [i, k] = pencils.pairs[task];
        const Cones::View& first = cones.views[i];
        const Cones::View& second = cones.views[k];
        PencilSide& first_side = pencils.side(i, k);
        PencilSide& second_side = pencils.side(k, i);
        auto& [first_entries, second_entries] = pencils.sort_buffers[worker];
        AngularOrder order(cones, i, k);
        sort_rays(cones, first, order, first_entries, first_side);
        sort_rays(cones, second, order, second_entries, second_side);
        merge_ranks(order, first, first_entries, first_side, second, second_entries, second_side);
        // both sides measure angles around the baseline from the first to the second camera
        const bool is_placed =
            place_strips(cones, first, order.baseline(), order.exact_baseline(), 1, first_side) &&
            place_strips(
                cones, second, -order.baseline(), cones.exact_baseline(k, i), -1, second_side);
        pencils.is_degenerate[task] = !is_placed || order.is_degenerate();
    };
    executor.parallel_for(pencils.pairs.size(), build_pair);
    return std::none_of(pencils.is_degenerate.begin(),
                        pencils.is_degenerate.end(),
                        [](std::uint8_t degenerate) { return degenerate != 0; });
}

}  // namespace atrium::hull
