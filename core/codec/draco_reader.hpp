#pragma once

#include "core/codec/mesh_codec.hpp"

#include <span>
#include <string_view>

namespace atrium::codec {

/// kInvalidData, of a mesh or its stream.
tl::unexpected<Error> invalid_mesh(std::string_view what);

/// Reads a mesh with Draco's own decoder: any stream of Draco 2.2, edgebreaker with standard
/// symbols and one attribute of positions. Replaces `out`, which on failure holds anything; limits
/// and failures as of MeshDecoder. Slower than EdgebreakerReader, and allocates.
Expected<void> read_with_draco(std::span<const std::uint8_t> bytes,
                               const MeshLimits& limits,
                               geometry::TriangleMesh& out);

}  // namespace atrium::codec
