#pragma once

#include "simulation/model_rig.hpp"

#include <assimp/matrix4x4.h>
#include <assimp/vector3.h>

#include <filesystem>

namespace Assimp {
class Importer;
}

namespace atrium::simulation {

inline Eigen::Affine3f to_eigen(const aiMatrix4x4& m) {
    Eigen::Affine3f transform;
    transform.matrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4,
        0.0f, 0.0f, 0.0f, 1.0f;
    return transform;
}

inline Eigen::Vector3f to_eigen(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// Reads a model or motion; `option` names it in errors: kNotFound, kInvalidData. The scene belongs
/// to `importer`.
Expected<const aiScene*> read_scene(const char* option,
                                    const std::filesystem::path& file,
                                    Assimp::Importer& importer);

/// Fills nodes, up axis and unit of `rig`. Nodes are in depth-first order. Error kInvalidData.
Expected<void> take_nodes(const aiScene& scene, const std::filesystem::path& file, ModelRig& rig);

/// Fills the keys of `rig` from the first animation that moves something, from time 0 on.
void take_animation(const aiScene& scene, ModelRig& rig);

}  // namespace atrium::simulation
