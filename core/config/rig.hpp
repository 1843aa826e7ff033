#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace atrium::config {

/// The cameras of one room: rig.toml (docs/conventions.md).
struct Rig {
    std::vector<geometry::CalibratedCamera> cameras;
    /// [m] Without bounds in the file: a person-sized box at the point nearest to all optical axes.
    geometry::Aabb bounds_site;
    double rate_hz = 30.0;
};

/// Reads and checks a rig: 2 to 64 cameras, names unique and valid, sizes in [16, 8192] px, focal
/// lengths positive, rotations right-handed and orthonormal to 1e-3 (then orthonormalised). `path`
/// is the file, or a folder that contains rig.toml.
Expected<Rig> load_rig(const std::filesystem::path& path);

/// True for a valid name of a site, camera, world or sender: 1..63 characters of [A-Za-z0-9_.-].
bool is_valid_name(const std::string& name);

}  // namespace atrium::config
