#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <filesystem>
#include <span>

namespace atrium::geometry {

/// Writes `mesh` in the format that the suffix of `path` names:
/// - `.ply`: binary, little-endian, positions in double precision
/// - `.obj`: text, all digits of the doubles
/// - `.gltf`, `.glb`: glTF 2.0 in one file; positions in single precision (the format has no
/// other), +Z up in the file's
///   buffer and turned to glTF's +Y up by the node
/// `normals`, if not empty: one unit vector per vertex, which is written along with it in single
/// precision; a zero one becomes +Z, as glTF has to have unit vectors.
/// An existing file is replaced. kConfiguration for an unknown suffix, kUnavailable where writing
/// fails.
Expected<void> write_mesh(const std::filesystem::path& path,
                          const TriangleMesh& mesh,
                          std::span<const Eigen::Vector3f> normals = {});

/// Whether `write_mesh` knows the suffix of `path`.
bool is_mesh_path(const std::filesystem::path& path);

}  // namespace atrium::geometry
