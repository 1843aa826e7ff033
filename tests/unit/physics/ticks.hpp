#pragma once

/// Times of the physics tests: ticks of the world, and meshes of people at 30 Hz.
namespace atrium::physics {

inline constexpr double kTickS = 1.0 / 120.0;
inline constexpr int kTicksPerMesh = 4;
inline constexpr double kMeshPeriodS = kTicksPerMesh * kTickS;

}  // namespace atrium::physics
