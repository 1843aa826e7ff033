#pragma once

#include "core/codec/mesh_codec.hpp"

#include <span>
#include <string_view>

namespace atrium::codec {

/// Makes an error kInvalidData about a mesh or its stream.
tl::unexpected<Error> invalid_mesh(std::string_view what);

/// Reads a mesh with Draco's own decoder: any Draco 2.2 stream with edgebreaker, standard symbols
/// and one position attribute. Replaces `out`, which is undefined on failure. Limits and errors are
/// those of MeshDecoder. Slower than EdgebreakerReader, and allocates.
Expected<void> read_with_draco(std::span<const std::uint8_t> bytes,
                               const MeshLimits& limits,
                               geometry::TriangleMesh& out);

}  // namespace atrium::codec
