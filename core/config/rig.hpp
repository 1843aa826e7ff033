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
    geometry::Aabb
        bounds_site;  // [m]; where the file has none: the box that all camera axes come close to
    double rate_hz = 30.0;
};

/// Reads and checks a rig: names unique and usable in topics, sizes in [16, 8192] px, focal lengths
/// positive, rotations orthonormal to 1e-3 (then made exactly so) and right-handed. `path` is the
/// file, or a folder that holds rig.toml.
Expected<Rig> load_rig(const std::filesystem::path& path);

/// Topic names of sites, cameras, worlds and senders: 1..63 characters of [A-Za-z0-9_.-].
bool is_valid_name(const std::string& name);

}  // namespace atrium::config
