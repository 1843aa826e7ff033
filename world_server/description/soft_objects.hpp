#pragma once

#include "core/base/fingerprint.hpp"
#include "core/config/table_reader.hpp"
#include "world_server/description/material.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/soft/soft_object.hpp"

#include <Eigen/Core>

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
    Fingerprint texture_fingerprint = {};           // see Look
    physics::SoftObject object;
    std::string where = {};  // place of its position in the file, for errors; empty: unknown
};

/// Returns the name of a place of a cloth or rope in a world file: "top", or "start" of a rope.
std::string pin_name(physics::PinPlace place, physics::SoftShape shape);

/// Reads all `[[soft]]` tables. Ids continue after those of `rigid`, the objects that `tied_to` may
/// name: one for all places in `tied`, or two, for one end of a rope each. Ignores texture,
/// restitution and rolling friction of materials. Problems go to `reader`.
std::vector<WorldSoftObject> read_soft_objects(config::TableReader& reader,
                                               const Materials& materials,
                                               const std::vector<WorldObject>& rigid);

}  // namespace atrium::world_server
