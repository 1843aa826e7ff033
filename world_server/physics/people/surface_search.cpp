// Finds the nearest samples of a surface.
#include "world_server/physics/people/float8.hpp"
#include "world_server/physics/people/surface_columns.hpp"
#include "world_server/physics/people/surface_index.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

namespace atrium::physics {
namespace {

constexpr Int8 kSteps = {0, 1, 2, 3, 4, 5, 6, 7};

ATRIUM_INLINE void floor8(const Float8& x, Int8& floors) {
    const Int8 cut = __builtin_convertvector(x, Int8);
    floors = cut + (x < __builtin_convertvector(cut, Float8));
}

ATRIUM_INLINE void clamp8(std::int32_t least, std::int32_t most, Int8& x) {
    x = x < least ? Int8{} + least : x;
    x = x > most ? Int8{} + most : x;
}

}  // namespace

struct SurfaceIndex::Search {
    static constexpr float kSlack = 1e-3F;  // in cells, for rounding
    // in cells; everything up to this distance is in one bundle
    static constexpr float kBeside = 0.5F;

    struct Limits {
        float radius_m = 0.0F;
        float min_cosine = 0.0F;
    };
    // Range of bundled samples near each of eight places.
    struct Runs {
        alignas(32) std::int32_t is_within[kFloat8Size];  // 0: nothing in reach
        alignas(32) std::int32_t has_bundle[kFloat8Size];
        alignas(32) std::int32_t first[kFloat8Size];  // index in bundle_begin_
        alignas(32) std::int32_t last[kFloat8Size];
    };
    struct Found {
        float distance_sq = 0.0F;
        std::int32_t at = -1;  // index in the bundles; -1: nothing
    };
    using Bundles = std::array<const float*, 6>;

    ATRIUM_INLINE static void find_runs(const SurfaceIndex& self,
                                        std::span<const SurfaceSample> places,
                                        float radius_m,
                                        Runs& runs) {
        std::array<std::array<float, kFloat8Size>, 3> at_places;
        for (std::size_t lane = 0; lane < kFloat8Size; ++lane) {
            const Eigen::Vector3f& p = places[std::min(lane, places.size() - 1)].position;
            at_places[0][lane] = p.x();
            at_places[1][lane] = p.y();
            at_places[2][lane] = p.z();
        }
        const float reach = radius_m * self.cells_per_m_ + kSlack;
        Int8 is_within = ~Int8{};
        std::array<Float8, 3> at;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            load8(at_places[axis].data(), at[axis]);
            at[axis] = (at[axis] - self.origin_[axis]) * self.cells_per_m_;
            is_within &= (at[axis] >= -reach) & (at[axis] <= self.last_cell_[axis] + reach + 1.0F);
        }
        // outside places may not fit into an integer
        for (Float8& x : at)
            x = reinterpret_cast<Float8>(is_within & reinterpret_cast<Int8>(x)) + kBeside;
        Int8 from, to, y, z;
        floor8(at[0] - 2.0F * kBeside, from);
        floor8(at[0], to);
        floor8(at[1], y);
        floor8(at[2], z);
        const Eigen::Array3i& dims = self.dims_;
        clamp8(0, dims.x(), from);
        to += 1;
        clamp8(0, dims.x(), to);
        const Int8 has_bundle = is_within & (y >= 0) & (y <= dims.y()) & (z >= 0) & (z <= dims.z());
        const Int8 row = (z * (dims.y() + 1) + y) * dims.x();
        const Int8 first = row + from;
        const Int8 last = row + to;
        std::memcpy(runs.is_within, &is_within, sizeof is_within);
        std::memcpy(runs.has_bundle, &has_bundle, sizeof has_bundle);
        std::memcpy(runs.first, &first, sizeof first);
        std::memcpy(runs.last, &last, sizeof last);
    }

    // Searches the bundled samples [begin, end). Almost without branches: neither the nearest
    // sample nor the number of samples is predictable. Samples beyond the end are read too, which
    // is harmless.
    ATRIUM_INLINE static void search(const Bundles& from,
                                     std::uint32_t begin,
                                     std::uint32_t end,
                                     const SurfaceSample& place,
                                     float min_cosine,
                                     Found& best) {
        Float8 least_sq = Float8{} + best.distance_sq;
        Int8 nearest = Int8{} + std::numeric_limits<std::int32_t>::max();
        const auto compare = [&](std::uint32_t i) __attribute__((always_inline)) {
            Float8 dx, dy, dz, nx, ny, nz;
            load_samples(from, i, dx, dy, dz, nx, ny, nz);
            dx -= place.position.x();
            dy -= place.position.y();
            dz -= place.position.z();
            const Float8 distance_sq = dx * dx + dy * dy + dz * dz;
            const Float8 cosine =
                nx * place.normal.x() + ny * place.normal.y() + nz * place.normal.z();
            const Int8 is_nearer = (distance_sq < least_sq) & (cosine > min_cosine);
            least_sq = is_nearer ? distance_sq : least_sq;
            nearest = is_nearer ? kSteps + static_cast<std::int32_t>(i) : nearest;
        };
        for (std::uint32_t n = 0; n < kSearchedAtLeast; n += kFloat8Size) compare(begin + n);
        for (std::uint32_t i = begin + kSearchedAtLeast; i < end; i += kFloat8Size) compare(i);
        const float least = min_of(least_sq);
        if (!(least < best.distance_sq)) return;
        const Int8 none = Int8{} + std::numeric_limits<std::int32_t>::max();
        best = {least, min_of(least_sq == least ? nearest : none)};
    }

    // Searches all bundles in reach.
    ATRIUM_INLINE static void search_around(const SurfaceIndex& self,
                                            const Bundles& bundles,
                                            const SurfaceSample& place,
                                            float min_cosine,
                                            Found& best) {
        const Eigen::Vector3f& p = place.position;
        const Float4 at = (Float4{p.x(), p.y(), p.z(), p.x()} - self.origin_) * self.cells_per_m_;
        const float reach = std::sqrt(best.distance_sq) * self.cells_per_m_ + kSlack;
        const Int4 from = floor4(at - reach);
        const Int4 to = floor4(at + reach);
        const Eigen::Array3i& dims = self.dims_;
        const int from_x = std::clamp(from[0], 0, dims.x());
        const int to_x = std::clamp(to[0] + 1, 0, dims.x());
        // a bundle has two rows each way
        for (int z = std::max(0, from[2]) + 1; z <= std::min(dims.z(), to[2] + 2); z += 2) {
            for (int y = std::max(0, from[1]) + 1; y <= std::min(dims.y(), to[1] + 2); y += 2) {
                const std::uint32_t* row =
                    self.bundle_begin_.data() + (z * (dims.y() + 1) + y) * dims.x();
                if (row[from_x] == row[to_x]) continue;
                search(bundles, row[from_x], row[to_x], place, min_cosine, best);
            }
        }
    }

    ATRIUM_INLINE static void nearest(const SurfaceIndex& self,
                                      std::span<const SurfaceSample> places,
                                      const Limits& limits,
                                      std::span<std::uint32_t> found) {
        const float beside_m = (kBeside - kSlack) * self.cell_m_;
        const Bundles bundles = pointers(self.bundled_);
        const std::uint32_t* const bundle_begin = self.bundle_begin_.data();
        const std::uint32_t* const bundled_sample = self.bundled_sample_.data();
        Runs runs;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const std::size_t lane = i % kFloat8Size;
            if (lane == 0) {
                const std::size_t num = std::min(kFloat8Size, places.size() - i);
                find_runs(self, places.subspan(i, num), limits.radius_m, runs);
            }
            Found best{limits.radius_m * limits.radius_m};
            if (runs.has_bundle[lane] != 0) {
                const std::uint32_t begin = bundle_begin[runs.first[lane]];
                const std::uint32_t end = bundle_begin[runs.last[lane]];
                search(bundles, begin, end, places[i], limits.min_cosine, best);
            }
            if (runs.is_within[lane] != 0 && best.distance_sq > beside_m * beside_m)
                search_around(self, bundles, places[i], limits.min_cosine, best);
            found[i] = best.at < 0 ? kNone : bundled_sample[best.at];
        }
    }

    // not inlined: the caller only chooses
    __attribute__((noinline)) static void nearest_plain(const SurfaceIndex& self,
                                                        std::span<const SurfaceSample> places,
                                                        const Limits& limits,
                                                        std::span<std::uint32_t> found) {
        nearest(self, places, limits, found);
    }
#ifdef ATRIUM_AVX2
    ATRIUM_AVX2 static void nearest_avx2(const SurfaceIndex& self,
                                         std::span<const SurfaceSample> places,
                                         const Limits& limits,
                                         std::span<std::uint32_t> found) {
        nearest(self, places, limits, found);
    }
#endif
};

void SurfaceIndex::nearest(std::span<const SurfaceSample> places,
                           float radius_m,
                           float min_cosine,
                           std::span<std::uint32_t> found) const {
    assert(found.size() == places.size());
    if (samples_.empty()) return std::fill(found.begin(), found.end(), kNone);
    const Search::Limits limits{radius_m, min_cosine};
#ifdef ATRIUM_AVX2
    if (uses_avx2()) return Search::nearest_avx2(*this, places, limits, found);
#endif
    Search::nearest_plain(*this, places, limits, found);
}

}  // namespace atrium::physics
