#pragma once

#include <random>

namespace atrium::test {

using Random = std::mt19937_64;  // the same numbers on every platform

inline double between(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

/// Both ends included.
inline int between(Random& random, int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
}

}  // namespace atrium::test
