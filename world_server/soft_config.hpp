#pragma once

#include "core/config/table_reader.hpp"
#include "world_server/description/material.hpp"
#include "world_server/physics/soft_object.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace atrium::world_server {

/// One soft object of the world as the file describes it.
struct WorldSoftObject {
    std::string name;
    Eigen::Vector3d colour{0.7, 0.7, 0.7};  // linear RGB, 0..1
    std::string texture = {};               // as bus::SceneObject has it
    physics::SoftObject object;
};

/// Reads all `[[soft]]`. Ids go on from `first_id`, in the order of the file. `id_of` knows the
/// rigid objects by name, for `tied_to`. Problems are kept by `reader`. A material's texture and
/// bounce are not for soft things.
std::vector<WorldSoftObject> read_soft_objects(
    config::TableReader& reader,
    const Materials& materials,
    std::uint32_t first_id,
    const std::function<std::optional<std::uint32_t>(const std::string& name)>& id_of);

}  // namespace atrium::world_server
