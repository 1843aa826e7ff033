#pragma once

#include "world_server/physics/people/float4.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

/// Processes eight floats at once, in one register or in two.
///
/// A function marked ATRIUM_AVX2 compiles everything inlined into it for AVX2. The results have the
/// same bits without AVX2.
#if defined(__x86_64__)
#define ATRIUM_AVX2 __attribute__((target("avx2")))
#endif
#define ATRIUM_INLINE inline __attribute__((always_inline))

namespace atrium::physics {

using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));  // result of a comparison: 0 or -1

inline constexpr std::size_t kFloat8Size = 8;

// By reference: passing these vectors by value depends on the instruction set.

ATRIUM_INLINE void load8(const float* from, Float8& values) {
    std::memcpy(&values, from, sizeof values);
}

ATRIUM_INLINE void store8(float* to, const Float8& values) {
    std::memcpy(to, &values, sizeof values);
}

ATRIUM_INLINE void halves(const Float8& values, Float4& low, Float4& high) {
    low = __builtin_shufflevector(values, values, 0, 1, 2, 3);
    high = __builtin_shufflevector(values, values, 4, 5, 6, 7);
}

ATRIUM_INLINE float sum_of(const Float8& values) {
    Float4 low, high;
    halves(values, low, high);
    return sum(low + high);
}

ATRIUM_INLINE float min_of(const Float8& values) {
    Float4 low, high;
    halves(values, low, high);
    low = min4(low, high);
    low = min4(low, __builtin_shufflevector(low, low, 2, 3, 0, 1));
    return std::min(low[0], low[1]);
}

ATRIUM_INLINE std::int32_t min_of(const Int8& values) {
    Int4 low = __builtin_shufflevector(values, values, 0, 1, 2, 3);
    const Int4 high = __builtin_shufflevector(values, values, 4, 5, 6, 7);
    low = low < high ? low : high;
    const Int4 swapped = __builtin_shufflevector(low, low, 2, 3, 0, 1);
    low = low < swapped ? low : swapped;
    return std::min(low[0], low[1]);
}

/// Returns one bit for each lane in which the mask is set.
ATRIUM_INLINE unsigned bits_of8(const Int8& mask) {
    return bits_of(__builtin_shufflevector(mask, mask, 0, 1, 2, 3)) |
           bits_of(__builtin_shufflevector(mask, mask, 4, 5, 6, 7)) << 4U;
}

}  // namespace atrium::physics
