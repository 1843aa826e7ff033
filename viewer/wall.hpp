#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "viewer/renderer/screen.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What one projector lights of a wall.
struct Tile {
    std::string name;
    renderer::Screen screen_wall;
};

/// A wall of several projectors, each of which has a viewer of its own. Its frame: origin on the
/// floor, +X to the right along the wall as one looks at it, +Y towards it, +Z up.
struct Wall {
    geometry::RigidTransform world_from_wall;
    Eigen::Vector3d eye_wall_m = {0.0, -2.0, 1.6};  // of those who look at it
    std::vector<Tile> tiles;

    const Tile* find(const std::string& tile) const;
    std::string tile_names() const;  // "left, right"
};

/// Reads a wall's file (docs/viewer.md, Displays). Error kConfiguration with file and line where it
/// makes no sense: a tile whose corners are no rectangle, or that the eye is not before.
Expected<Wall> load_wall(const std::filesystem::path& file);

}  // namespace atrium::viewer
