#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "viewer/renderer/screen.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::viewer {

/// The part of a wall that one projector lights.
struct Tile {
    std::string name;
    renderer::Screen screen_wall;
};

/// A wall lit by several projectors, each with its own viewer. Frame: origin on the floor, +X to
/// the right along the wall as seen by the audience, +Y towards the wall, +Z up.
struct Wall {
    geometry::RigidTransform world_from_wall;
    Eigen::Vector3d eye_wall_m = {0.0, -2.0, 1.6};  // eye of the audience
    std::vector<Tile> tiles;

    const Tile* find(const std::string& tile) const;
    std::string tile_names() const;  // For example "left, right".
};

/// Reads a wall file (docs/viewer.md, Displays). Error kConfiguration with file and line if it is
/// invalid, for example if the corners of a tile form no rectangle or the eye is not before it.
Expected<Wall> load_wall(const std::filesystem::path& file);

}  // namespace atrium::viewer
