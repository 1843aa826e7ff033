#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

/// Processes four floats at once with the compiler's vector extension (SSE2 or NEON). Both give the
/// same results.
namespace atrium::physics {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));  // result of a comparison: 0 or -1

inline constexpr std::size_t kFloat4Size = 4;

inline Float4 load4(const float* values) {
    Float4 loaded;
    std::memcpy(&loaded, values, sizeof loaded);
    return loaded;
}

inline void store4(float* values, Float4 stored) { std::memcpy(values, &stored, sizeof stored); }

inline Float4 all4(float value) { return Float4{value, value, value, value}; }

/// Returns one bit for each lane in which the mask is set.
inline unsigned bits_of(Int4 mask) {
#ifdef __SSE2__
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
#else
    unsigned bits = 0;
    for (unsigned lane = 0; lane < 4; ++lane) bits |= mask[lane] != 0 ? 1U << lane : 0U;
    return bits;
#endif
}

/// Returns `values` where the mask is set, 0 elsewhere.
inline Float4 where(Int4 mask, Float4 values) {
    return reinterpret_cast<Float4>(mask & reinterpret_cast<Int4>(values));
}

/// Rounds down, for |x| below 2^31.
inline Int4 floor4(Float4 x) {
    const Int4 cut = __builtin_convertvector(x, Int4);
    return cut + (x < __builtin_convertvector(cut, Float4));
}

inline Float4 min4(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 max4(Float4 a, Float4 b) { return a > b ? a : b; }

/// Returns (y, z, x, w) of (x, y, z, w).
inline Float4 yzx(Float4 v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }

/// Cross product of the first three lanes. The fourth lane of the result is 0 if it is 0 in both.
inline Float4 cross4(Float4 a, Float4 b) { return yzx(a * yzx(b) - yzx(a) * b); }

inline float sum(Float4 values) { return (values[0] + values[1]) + (values[2] + values[3]); }

}  // namespace atrium::physics
