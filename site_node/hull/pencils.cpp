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

// Returns a monotone function of the angle of `v`, in [-2, 2]: opposite directions differ by
// exactly 2, a full turn is 4.
double pseudo_angle(const Eigen::Vector2d& v) {
    const double sum = std::abs(v.x()) + std::abs(v.y());
    if (sum == 0.0) return 0.0;
    const double p = v.x() / sum;
    return v.y() < 0.0 ? p - 1.0 : 1.0 - p;
}

// Orders the rays of both cameras of a pair by angle around the baseline, in (-pi, pi] from a
// coordinate axis across it. A floating-point filter decides where its error bound allows, exact
// predicates elsewhere. Error bounds: docs/design/hull.md, "The filter".
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
    // 0: below the zero axis, the first half of the interval; 1: above it. On it: degenerate.
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

// An entry packed into one number, for sorting by angle: the angle in steps of 4.5e-13, then the
// index in the list of entries.
constexpr unsigned kPlaceBits = 20;
constexpr std::uint64_t kPlaceMask = (std::uint64_t{1} << kPlaceBits) - 1;
constexpr double kStepsPerUnit = 2199023255552.0;  // 2^41: a turn of 4 and 20 index bits fit
static_assert(kMaxStrips < (1u << kPlaceBits));

std::uint64_t sort_key(double angle, std::uint32_t place) {
    const auto steps = static_cast<std::int64_t>((angle + 2.0) * kStepsPerUnit);
    return static_cast<std::uint64_t>(steps) << kPlaceBits | place;
}

// Returns the difference of two keys above which their order is certain, for angles within the
// error bounds of both sorted lists.
std::uint64_t certain_gap(const Cones& cones,
                          const Pencils::Sorting& first,
                          const Pencils::Sorting& second) {
    constexpr auto kNever = std::numeric_limits<std::uint64_t>::max();
    const double error = first.largest_error + second.largest_error;
    if (cones.only_exact || !(error < 0.5)) return kNever;
    // truncation and rounding of the keys amount to less than three steps together
    const std::uint64_t steps = sort_key(error - 2.0, 0) + (std::uint64_t{3} << kPlaceBits);
    // near the ends of the interval a rounded angle may have come out at the other end
    const std::uint64_t greatest = sort_key(2.0, 0) - steps;
    for (const auto* keys : {&first.keys, &second.keys}) {
        if (!keys->empty() && (keys->front() < steps || keys->back() > greatest)) return kNever;
    }
    return steps;
}

// Merges [begin, middle) and [middle, end) without a branch on the keys.
void merge(const std::uint64_t* begin,
           const std::uint64_t* middle,
           const std::uint64_t* end,
           std::uint64_t* to) {
    const std::uint64_t* l = begin;
    const std::uint64_t* r = middle;
    while (l != middle && r != end) {
        const bool is_left = *l < *r;
        *to++ = is_left ? *l : *r;
        l += is_left ? 1 : 0;
        r += is_left ? 0 : 1;
    }
    to = std::copy(l, middle, to);
    std::copy(r, end, to);
}

// Sorts keys by merging their runs. Along an outline the angle rises or falls for a while, so there
// are few runs.
void sort_runs(std::vector<std::uint64_t>& keys, Pencils::SortBuffers& buffers) {
    std::vector<std::uint32_t>& ends = buffers.run_ends;
    ends.clear();
    const auto n = static_cast<std::uint32_t>(keys.size());
    for (std::uint32_t begin = 0; begin < n; begin = ends.back()) {
        std::uint32_t end = begin + 1;
        if (end < n && keys[end] < keys[begin]) {
            while (end < n && keys[end] < keys[end - 1]) ++end;
            std::reverse(keys.begin() + begin, keys.begin() + end);
        } else {
            while (end < n && keys[end] > keys[end - 1]) ++end;
        }
        ends.push_back(end);
    }
    buffers.merged.resize(n);
    while (ends.size() > 1) {
        std::size_t num_merged = 0;
        std::uint32_t begin = 0;
        for (std::size_t r = 0; r < ends.size(); r += 2) {
            const std::uint32_t middle = ends[r];
            const std::uint32_t end = r + 1 < ends.size() ? ends[r + 1] : middle;
            merge(keys.data() + begin,
                  keys.data() + middle,
                  keys.data() + end,
                  buffers.merged.data() + begin);
            ends[num_merged++] = begin = end;
        }
        ends.resize(num_merged);
        std::swap(keys, buffers.merged);
    }
}

void put_in_order(const Cones& cones, const Cones::View& view, PencilSide& side) {
    const std::size_t n = side.sorted.size();
    side.in_order.resize(n + PencilSide::kSpareRays);
    PencilSide::InOrder* const to = side.in_order.data();
    const Eigen::Vector3d* const rays = cones.ray.data() + view.first_ray;
    const double* const lengths = cones.ray_length.data() + view.first_ray;
    for (std::size_t at = 0; at < n; ++at) {
        const std::uint32_t local = side.sorted[at];
        const Eigen::Vector2d& across = side.across[local];
        const Eigen::Vector3d& ray = rays[local];
        to[at] = {across.x(),
                  across.y(),
                  ray.x(),
                  ray.y(),
                  ray.z(),
                  lengths[local],
                  {kNoStrip, kNoStrip},
                  local};
    }
    if (n > 0) std::fill_n(to + n, PencilSide::kSpareRays, to[n - 1]);
}

void sort_rays(const Cones& cones,
               const Cones::View& view,
               AngularOrder& order,
               Pencils::Sorting& sorting,
               Pencils::SortBuffers& buffers,
               PencilSide& side) {
    const std::uint32_t n = view.last_ray - view.first_ray;
    side.across.resize(n);
    side.sorted.resize(n);
    side.position.resize(n);
    side.rank.resize(n);
    sorting.entries.resize(n);
    sorting.keys.resize(n);
    sorting.largest_error = 0.0;
    for (std::uint32_t j = 0; j < n; ++j) {
        side.across[j] = order.across(cones.ray[view.first_ray + j]);
        const Entry entry = order.entry(view.first_ray + j, side.across[j]);
        sorting.entries[j] = entry;
        sorting.keys[j] = sort_key(entry.angle, j);
        sorting.largest_error = std::max(sorting.largest_error, entry.error);
    }
    sort_runs(sorting.keys, buffers);
    // the keys are almost in order; insertion sort completes it exactly
    const std::uint64_t gap = certain_gap(cones, sorting, sorting);
    std::uint64_t* const keys = sorting.keys.data();
    for (std::size_t at = 1; at < n; ++at) {
        if (keys[at] - keys[at - 1] > gap) continue;
        for (std::size_t to = at; to > 0; --to) {
            const Entry& entry = sorting.entries[keys[to] & kPlaceMask];
            const Entry& before = sorting.entries[keys[to - 1] & kPlaceMask];
            if (!order.is_before(entry, before)) break;
            std::swap(keys[to], keys[to - 1]);
        }
    }
    for (std::uint32_t at = 0; at < n; ++at) {
        const auto local = static_cast<std::uint32_t>(keys[at] & kPlaceMask);
        side.sorted[at] = local;
        side.position[local] = at;
    }
    put_in_order(cones, view, side);
}

// Finds the ranks of both sides by one merge.
void merge_ranks(const Cones& cones,
                 AngularOrder& order,
                 const Pencils::Sorting& first_sorting,
                 PencilSide& first,
                 const Pencils::Sorting& second_sorting,
                 PencilSide& second) {
    const std::uint64_t gap = certain_gap(cones, first_sorting, second_sorting);
    const std::vector<std::uint64_t>& first_keys = first_sorting.keys;
    const std::vector<std::uint64_t>& second_keys = second_sorting.keys;
    const auto num_first = static_cast<std::uint32_t>(first_keys.size());
    const auto num_second = static_cast<std::uint32_t>(second_keys.size());
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    while (a < num_first && b < num_second) {
        const std::uint64_t l = first_keys[a];
        const std::uint64_t r = second_keys[b];
        bool is_first = l < r;
        if ((is_first ? r - l : l - r) <= gap) {
            is_first = order.is_before(first_sorting.entries[l & kPlaceMask],
                                       second_sorting.entries[r & kPlaceMask]);
        }
        if (is_first) {
            first.rank[l & kPlaceMask] = b;
            ++a;
        } else {
            second.rank[r & kPlaceMask] = a;
            ++b;
        }
    }
    for (; a < num_first; ++a) first.rank[first_keys[a] & kPlaceMask] = b;
    for (; b < num_second; ++b) second.rank[second_keys[b] & kPlaceMask] = a;
}

// Places the strips among the sorted rays. `baseline`: from this centre to the other. `sense`: 1 if
// angles grow in the right-handed sense around it, -1 if in the left-handed. False if the plane of
// a strip contains the baseline.
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
    const double baseline_length = baseline.norm();
    const double error_scale = 10.0 * kRounding * baseline_length;
    side.inverse_baseline = 1.0 / baseline_length;
    PencilSide::InOrder* const in_order = side.in_order.data();
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
        // normal = to x from, so baseline . (from x to) is the negative of offset
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
        if (cones.incidence[from].count == 2) in_order[begin].through[rises ? 1 : 0] = strip;
        if (cones.incidence[to].count == 2) in_order[end].through[rises ? 0 : 1] = strip;
        const std::uint32_t upper = rises ? to : from;
        const auto& incident = cones.incidence[upper].strips;
        const unsigned j = incident[0] == strip ? 0 : incident[1] == strip ? 1 : 2;
        side.is_upper_end[upper - view.first_ray] |= static_cast<std::uint8_t>(1u << j);
    }
    for (PencilSide::InOrder& ray : side.in_order) {
        auto& [ends, begins] = ray.through;
        if (ends == kNoStrip || begins == kNoStrip) ends = begins = kNoStrip;
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
        Pencils::SortBuffers& buffers = pencils.sort_buffers[worker];
        auto& [first_sorting, second_sorting] = buffers.sides;
        AngularOrder order(cones, i, k);
        sort_rays(cones, first, order, first_sorting, buffers, first_side);
        sort_rays(cones, second, order, second_sorting, buffers, second_side);
        merge_ranks(cones, order, first_sorting, first_side, second_sorting, second_side);
        // both sides measure angles around the baseline from the first camera to the second
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
