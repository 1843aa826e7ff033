#pragma once

#include "core/base/expected.hpp"
#include "core/base/fingerprint.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/rigid/rigid_object.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace atrium::world_server {

using ModelParts = std::shared_ptr<const std::vector<geometry::TriangleMesh>>;

struct LoadedModel {
    ModelParts parts;                          // hulls
    ModelSurface surface;                      // see WorldObject
    std::string own_texture;                   // picture that the file names; empty: none
    std::string missing_materials;             // see Look
    bool is_see_through = false;               // see Look
    std::vector<Eigen::Vector3d> own_colours;  // different ones that the file states
    Fingerprint fingerprint;                   // of the file and those that it names
};

/// Reads a model and creates its hulls: one around everything for a convex shape, one per part of
/// the file for a compound. Errors name the file or the part.
Expected<LoadedModel> load_model_parts(const std::filesystem::path& file,
                                       double scale,
                                       physics::ObjectShape shape);

}  // namespace atrium::world_server
