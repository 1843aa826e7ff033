#pragma once

#include "core/config/table_reader.hpp"
#include "world_server/description/material.hpp"
#include "world_server/physics/soft/soft_object.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace atrium::world_server {

/// A soft object as described in the world file.
struct WorldSoftObject {
    std::string name;
    Eigen::Vector3d colour{0.7, 0.7, 0.7};  // linear RGB, 0..1
    std::string texture = {};               // a picture; empty: none
    std::string model = {};                 // file of a model; empty: none
    double model_scale = 1.0;               // [m] per unit of the model
    std::string own_texture = {};           // picture that the model's file names; not drawn
    std::vector<Eigen::Vector3d> own_colours = {};  // see Look
    physics::SoftObject object;
};

/// Reads all `[[soft]]` tables. Ids start at `first_id`, in file order. `id_of` finds rigid objects
/// by name, for `tied_to`. Ignores texture, restitution and rolling
/// friction of materials. Problems go to `reader`.
std::vector<WorldSoftObject> read_soft_objects(
    config::TableReader& reader,
    const Materials& materials,
    std::uint32_t first_id,
    const std::function<std::optional<std::uint32_t>(const std::string& name)>& id_of);

}  // namespace atrium::world_server
