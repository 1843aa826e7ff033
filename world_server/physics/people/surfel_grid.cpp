#include "world_server/physics/people/surfel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace atrium::physics {
namespace {

constexpr float kMaxCells = 3e5F;  // widely spread surfels get larger cells, not more

// Surfels are read and written four floats at a time. The fourth belongs to the next member.
constexpr std::size_t kNormalAt = 3;
constexpr std::size_t kFromAt = 6;
constexpr std::size_t kVelocityAt = 9;
static_assert(sizeof(MovingSurfel) == 12 * sizeof(float));
static_assert(offsetof(MovingSurfel, normal) == kNormalAt * sizeof(float));
static_assert(offsetof(MovingSurfel, from) == kFromAt * sizeof(float));
static_assert(offsetof(MovingSurfel, velocity) == kVelocityAt * sizeof(float));
static_assert(sizeof(PlacedSurfel) == 9 * sizeof(float));
static_assert(offsetof(PlacedSurfel, normal) == kNormalAt * sizeof(float));
static_assert(offsetof(PlacedSurfel, velocity) == (kNormalAt + 3) * sizeof(float));

const float* floats_of(const MovingSurfel& surfel) {
    return reinterpret_cast<const float*>(&surfel);
}

float* floats_of(PlacedSurfel& surfel) { return reinterpret_cast<float*>(&surfel); }

// Returns the octant of a direction as one bit of eight.
std::uint8_t octant_of(Float4 direction) {
    return static_cast<std::uint8_t>(1U << (bits_of(direction < 0.0F) & 7U));
}

}  // namespace

void SurfelGrid::place(std::span<const MovingSurfel> surfels, float share_to_go) {
    places_.resize(surfels.size());
    Float4 low = all4(std::numeric_limits<float>::max());
    Float4 high = -low;
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        const float* values = floats_of(surfels[i]);
        const Float4 position = load4(values);
        const Float4 place = position + share_to_go * (load4(values + kFromAt) - position);
        low = min4(place, low);
        high = max4(place, high);
        places_[i] = place;
    }
    low_ = {low[0], low[1], low[2]};
    high_ = {high[0], high[1], high[2]};
}

void SurfelGrid::fit_cells(float cell_m) {
    const Eigen::Array3f size = (high_ - low_).array();
    while (((size / cell_m).floor() + 1.0F).prod() > kMaxCells) cell_m *= 1.5F;
    inverse_cell_ = 1.0F / cell_m;
    dims_ = cell_of(high_) + 1;
}

void SurfelGrid::assign(std::span<const MovingSurfel> surfels,
                        float share_to_go,
                        float share_of_velocity,
                        float cell_m) {
    surfels_.resize(surfels.size());
    if (surfels.empty()) return;
    place(surfels, share_to_go);
    fit_cells(cell_m);

    const auto num_cells = static_cast<std::size_t>(dims_.prod());
    octants_near_.assign(num_cells, 0);
    // counting sort
    cell_begin_.assign(num_cells + 1, 0);
    cell_of_surfel_.resize(surfels.size());
    const Float4 low{low_.x(), low_.y(), low_.z(), 0.0F};
    const Float4 per_m = all4(inverse_cell_);
    const Int4 dims{dims_.x(), dims_.y(), dims_.z(), 0};
    // local copies: the compiler must assume that the stores below change the members
    const std::size_t num = surfels.size();
    const MovingSurfel* const from = surfels.data();
    const Float4* const places = places_.data();
    std::uint32_t* const cells = cell_of_surfel_.data();
    std::uint32_t* const begin = cell_begin_.data();
    std::uint8_t* const octants = octants_near_.data();
    for (std::size_t i = 0; i < num; ++i) {
        // no place is below `low_`: truncation rounds down
        const Int4 cell = __builtin_convertvector((places[i] - low) * per_m, Int4);
        const auto index =
            static_cast<std::uint32_t>((cell[2] * dims[1] + cell[1]) * dims[0] + cell[0]);
        cells[i] = index;
        ++begin[index];
        octants[index] |= octant_of(load4(floats_of(from[i]) + kNormalAt));
    }
    std::uint32_t end = 0;
    for (std::size_t cell = 0; cell <= num_cells; ++cell) begin[cell] = end += begin[cell];
    // backwards: each cell's end counts down to its begin
    PlacedSurfel* const to = surfels_.data();
    for (std::size_t i = num; i-- > 0;) {
        float* values = floats_of(to[--begin[cells[i]]]);
        const Float4 normal = load4(floats_of(from[i]) + kNormalAt);
        const Float4 velocity = load4(floats_of(from[i]) + kVelocityAt - 1) * share_of_velocity;
        store4(values, places[i]);
        store4(values + kNormalAt, normal);
        store4(values + kNormalAt + 2, __builtin_shufflevector(normal, velocity, 2, 5, 6, 7));
    }
    spread_octants();
}

// Spreads octants by one cell in each direction, axis by axis.
void SurfelGrid::spread_octants() {
    const std::size_t num = octants_near_.size();
    spreading_.resize(num);
    for (const int axis_step : {1, dims_.x(), dims_.x() * dims_.y()}) {
        const std::size_t step = std::min(static_cast<std::size_t>(axis_step), num);
        std::swap(octants_near_, spreading_);
        // steps across the end of a row add a cell too many, which is harmless
        const std::uint8_t* from = spreading_.data();
        std::uint8_t* to = octants_near_.data();
        std::copy(from, from + num, to);
        for (std::size_t i = 0; i + step < num; ++i) to[i] |= from[i + step];
        for (std::size_t i = step; i < num; ++i) to[i] |= from[i - step];
    }
}

}  // namespace atrium::physics
