#pragma once

#include "core/base/expected.hpp"
#include "core/base/valid_name.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace atrium::config {

/// Limits of fx and fy, as in the hull (site_node/hull/input_limits.hpp).
inline constexpr double kMinFocal_px = 1e-3;
inline constexpr double kMaxFocal_px = 1e6;

/// The cameras of one room: rig.toml (docs/conventions.md).
struct Rig {
    std::vector<geometry::CalibratedCamera> cameras;
    /// [m] Where people can be: the hull is cut there if the file says so (`has_bounds`). Without
    /// bounds in the file: a person-sized box at the point nearest to all optical axes.
    geometry::Aabb bounds_site;
    bool has_bounds = false;
    double rate_hz = 30.0;
    double unit_m = 1.0;  // of the translations and bounds in the file; here all is in metres
};

/// Reads and checks a rig: 2 to 64 cameras, names unique and valid, sizes in [16, 8192] px, focal
/// lengths in [0.001, 1000000] px, rotations right-handed and orthonormal to 1e-3 (then
/// orthonormalised). Converts lengths of its `units` to metres. `path` is the file, or a folder
/// that contains rig.toml.
Expected<Rig> load_rig(const std::filesystem::path& path);

/// The same for equal cameras, on any host: names, sizes, lenses and poses, to single precision.
std::uint64_t fingerprint(const Rig& rig);

using atrium::is_valid_name;

}  // namespace atrium::config
