#pragma once

#include "core/base/valid_name.hpp"

#include <cstddef>
#include <cstdint>

/// Bounds the contents of samples. Writers and readers reject what exceeds them. The bounds of
/// sequences are repeated in idl/.
namespace atrium::bus {

// Cyclone uses the ports from 7400 + 250 * domain; above this domain they exceed 65535.
inline constexpr std::uint32_t kMaxDomain = 230;
using atrium::kMaxNameLength;
inline constexpr std::size_t kMaxCamerasPerSite = 64;
inline constexpr std::size_t kMaxCodedBytes = 8U << 20U;   // 30 times the largest expected sample
inline constexpr std::size_t kMaxContours = 2000;          // of a CameraSilhouette, as in hulls
inline constexpr std::size_t kMaxContourVertices = 65536;  // a CameraSilhouette then has 1 MB
inline constexpr std::size_t kMaxRegions = 64;             // of a site
inline constexpr std::size_t kMaxOrderContours = 16000;    // of a RegionOrder
inline constexpr std::size_t kMaxOrderVertices = 524288;   // a RegionOrder then has 8 MB
inline constexpr double kMaxVertex_px = 1e9;      // undistorted: may lie far outside of the picture
inline constexpr std::size_t kMaxObjects = 2048;  // a SceneState then has 0.23 MB
inline constexpr std::size_t kMaxModelFileLength = 127;
inline constexpr std::size_t kMaxSavedWorlds = 256;
inline constexpr std::size_t kMaxTextLength = 255;  // EditResult::text
inline constexpr std::size_t kMaxRevocationBytes = 256U << 10U;
inline constexpr std::size_t kMaxSoftNodes = 4096;  // a SoftBodyState then has 25 kB
inline constexpr std::size_t kMaxSoftTriangles = 8192;
inline constexpr std::size_t kMaxSoftSegments = 4096;
inline constexpr std::size_t kMaxProxyPoints = 2048;  // a PersonProxy then has 37 kB
inline constexpr std::size_t kMaxTouches = 256;
inline constexpr std::size_t kMaxProxyVertices = 4096;
inline constexpr std::size_t kMaxProxyEdges = 12288;
inline constexpr double kMaxModelScale = 1e4;  // [m] per unit of a model
// Viewers draw no larger textures, and world servers read none.
inline constexpr std::uintmax_t kMaxTextureFileBytes = std::uintmax_t{16} << 20U;
inline constexpr double kMaxFriction = 10.0;
inline constexpr double kMaxThickness_m = 1.0;
inline constexpr double kMaxSoftStep_m = 1.0;  // quantisation step of nodes
inline constexpr double kMaxProxyStep_m = 1.0;
inline constexpr int kMaxImageSide_px = 16384;
inline constexpr double kMaxCoordinate_m = 1e5;
inline constexpr double kMaxSpeed = 1e5;            // [m/s], [rad/s]
inline constexpr double kMaxMass_kg = 1e6;          // impulses: kMaxMass_kg * 1 m/s
inline constexpr double kMaxIntrinsic = 1e7;        // fx, fy, cx, cy, skew [px], distortion
inline constexpr double kMaxStatistic = 1e15;       // rates, latencies
inline constexpr std::uint32_t kMaxSendEvery = 64;  // StreamState::send_every
/// Largest deviation of a quaternion's length from 1. Within it readers normalise, beyond it they
/// reject the sample.
inline constexpr double kQuaternionTolerance = 1e-3;
/// The year 2116. Differences of two times within it cannot overflow.
inline constexpr std::int64_t kMaxTime_ns = std::int64_t{1} << 62;

}  // namespace atrium::bus
