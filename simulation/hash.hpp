#pragma once

#include <cmath>
#include <cstdint>

namespace atrium::simulation {

/// Splitmix64 of two numbers: other noise for other pictures.
inline std::uint64_t hash_of(std::uint64_t a, std::uint64_t b) {
    std::uint64_t v = a * 0x9e3779b97f4a7c15ULL + b + 0x632be59bd9b4e019ULL;
    v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ULL;
    v = (v ^ (v >> 27)) * 0x94d049bb133111ebULL;
    return v ^ (v >> 31);
}

/// A time as a number for `hash_of`.
inline std::uint64_t microseconds(double time_s) {
    return static_cast<std::uint64_t>(std::llround(time_s * 1e6));
}

}  // namespace atrium::simulation
