#pragma once

#include "core/codec/mesh_codec.hpp"

namespace atrium::test {

/// Like codec::MeshDecoder::decode, with temporary memory.
inline Expected<geometry::TriangleMesh> decode_mesh(std::span<const std::uint8_t> bytes,
                                                    const codec::MeshLimits& limits = {}) {
    geometry::TriangleMesh mesh;
    if (auto ok = codec::MeshDecoder().decode(bytes, limits, mesh); !ok)
        return tl::unexpected(std::move(ok.error()));
    return mesh;
}

}  // namespace atrium::test
