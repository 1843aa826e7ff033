#pragma once

#include <algorithm>
#include <cmath>

namespace atrium {

inline constexpr double kMaxObjectMass_kg = 10'000.0;
inline constexpr double kMinDensity_kg_per_m3 = 1.0;       // about a balloon
inline constexpr double kMaxDensity_kg_per_m3 = 30'000.0;  // denser than any metal in use

struct MassRange {
    double least_kg;
    double most_kg;
};

/// Masses that the world server accepts for a movable object of that volume, to three digits that
/// lie within the exact limits. The volume must be positive.
inline MassRange allowed_masses(double volume_m3) {
    const auto rounded = [](double value, auto round) {
        const double step = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
        return round(value / step) * step;
    };
    return {rounded(kMinDensity_kg_per_m3 * volume_m3, [](double v) { return std::ceil(v); }),
            std::min(kMaxObjectMass_kg, rounded(kMaxDensity_kg_per_m3 * volume_m3, [](double v) {
                         return std::floor(v);
                     }))};
}

}  // namespace atrium
