#pragma once

#include "core/codec/mesh_codec.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <array>
#include <cstdint>
#include <set>
#include <vector>

namespace atrium::test {

using Bytes = std::vector<std::uint8_t>;

/// Triangles by position, each rotated to its smallest form (corners may coincide).
using Triangles = std::multiset<std::array<std::array<float, 3>, 3>>;

/// The stream of Draco's own encoder. Empty if Draco refuses.
Bytes draco_bytes(const geometry::TriangleMesh& mesh, const codec::MeshCodecOptions& options);

/// The mesh that Draco's decoder makes of a stream.
Triangles triangles_of(const Bytes& bytes);

/// The triangles of `mesh` rounded to the grid of its stream, computed in floats.
Triangles quantised(const geometry::TriangleMesh& mesh, int position_bits);

}  // namespace atrium::test
