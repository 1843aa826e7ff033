// Cuts a surface into regions, links neighbours, and runs the steps of the motion estimate.
#include "world_server/physics/people/person_motion.hpp"

#include "world_server/physics/people/motion_match.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

namespace atrium::physics {
namespace {

using motion::is_explained_by;

constexpr std::size_t kMaxCells = 1U << 20;  // of a lattice

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

bool MotionEstimator::Octant::moves(float moving_share) const {
    return static_cast<float>(num_unexplained) > moving_share * static_cast<float>(num);
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
        const bool is_explained =
            is_explained_by(*before_, matched_[n], places_[n], options_.match.explained_m);
        unsorted_.push_back({static_cast<std::uint32_t>(n * stride), matched_[n], is_explained});
        Octant& octant = octants_[octant_lattice_.index_of(places_[n].position)];
        ++octant.num;
        if (!is_explained) ++octant.num_unexplained;
    }
    sort_points_by_region();
}

void MotionEstimator::match_places(const SurfaceIndex& surface) {
    matched_.resize(places_.size());
    motion::match(surface, places_, options_.match, matched_);
}

void MotionEstimator::sort_points_by_region() {
    const auto samples = now_->samples();
    region_at_.assign(2 * region_lattice_.num_cells, 0);
    slots_.clear();
    for (const Point& point : unsorted_) {
        const Eigen::Vector3f& position = samples[point.sample].position;
        const bool moves =
            octants_[octant_lattice_.index_of(position)].moves(options_.moving_share);
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
    const float near_sq = options_.near_m * options_.near_m;
    neighbours_.clear();
    for (std::uint32_t r = 0; r < regions_.size(); ++r) {
        Region& region = regions_[r];
        region.first_neighbour = static_cast<std::uint32_t>(neighbours_.size());
        for (std::uint32_t l = first_link_[r]; l != kNoRegion; l = links_[l].next) {
            const Region& other = regions_[links_[l].to];
            const float nearness =
                static_cast<float>(other.num) *
                std::exp(-(other.centre - region.centre).squaredNorm() / near_sq);
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
    const float touch_m = options_.touch_m;
    touch_lattice_.fit(now_->bounds(), static_cast<double>(touch_m));
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
                    bits_of((off_x * off_x + off_y * off_y + off_z * off_z < touch_m * touch_m) &
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

}  // namespace atrium::physics
