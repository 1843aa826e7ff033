#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <filesystem>
#include <span>

namespace atrium::geometry {

/// Writes `mesh` in the format that the suffix of `path` names:
/// - `.ply`: binary, little-endian, positions in double precision
/// - `.obj`: text, all digits of the doubles
/// - `.gltf`, `.glb`: glTF 2.0 in one file, positions in single precision (the format has no
///   other), +Z up in the buffer; the node rotates to glTF's +Y up
/// `normals`, if not empty: one unit vector per vertex, written in single precision. A zero normal
/// becomes +Z, because glTF requires unit vectors.
/// Replaces an existing file. Fails with kConfiguration for an unknown suffix, with kUnavailable if
/// the file cannot be written.
Expected<void> write_mesh(const std::filesystem::path& path,
                          const TriangleMesh& mesh,
                          std::span<const Eigen::Vector3f> normals = {});

/// True if `write_mesh` supports the suffix of `path`.
bool is_mesh_path(const std::filesystem::path& path);

}  // namespace atrium::geometry
