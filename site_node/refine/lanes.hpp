#pragma once

#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#define ATRIUM_AVX2 __attribute__((target("avx2")))
#endif
#define ATRIUM_INLINE inline __attribute__((always_inline))

namespace atrium::refine {

/// Vectors of eight, for templates that are inlined into functions for each instruction set. Pass
/// them by reference: their calling convention depends on the instruction set.
inline constexpr int kLanes = 8;
using Floats = float __attribute__((vector_size(4 * kLanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * kLanes)));
using Words = std::uint32_t __attribute__((vector_size(4 * kLanes)));

/// Of all lanes, in the same order for all instruction sets.
ATRIUM_INLINE float sum_of(const Floats& v) {
    return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

}  // namespace atrium::refine
