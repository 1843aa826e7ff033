#pragma once

#include <numbers>

namespace atrium::geometry {

/// Volumes of simple shapes of a diameter and a height over all [m^3].
inline double cylinder_volume(double diameter, double height) {
    return std::numbers::pi / 4.0 * diameter * diameter * height;
}
inline double sphere_volume(double diameter) {
    return cylinder_volume(diameter, diameter * 2.0 / 3.0);
}
inline double capsule_volume(double diameter, double height) {
    return cylinder_volume(diameter, height - diameter / 3.0);
}

}  // namespace atrium::geometry
