#pragma once

#include "world_server/physics/people/float8.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

// Shared by the source files of SurfaceIndex: samples by coordinate, x, y, z of position, then of
// normal.
namespace atrium::physics {

inline constexpr float kFarM = 1e6F;  // distance from every sample
// A search reads at least this many samples. Places seldom have more beside them.
inline constexpr std::uint32_t kSearchedAtLeast = 3 * kFloat8Size;

template <typename Columns>
auto pointers(Columns& columns) {
    return std::array{columns[0].data(),
                      columns[1].data(),
                      columns[2].data(),
                      columns[3].data(),
                      columns[4].data(),
                      columns[5].data()};
}

/// Loads eight samples from index `at`.
ATRIUM_INLINE void load_samples(const std::array<const float*, 6>& from,
                                std::size_t at,
                                Float8& x,
                                Float8& y,
                                Float8& z,
                                Float8& normal_x,
                                Float8& normal_y,
                                Float8& normal_z) {
    load8(from[0] + at, x);
    load8(from[1] + at, y);
    load8(from[2] + at, z);
    load8(from[3] + at, normal_x);
    load8(from[4] + at, normal_y);
    load8(from[5] + at, normal_z);
}

}  // namespace atrium::physics
