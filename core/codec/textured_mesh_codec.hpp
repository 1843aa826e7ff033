#pragma once

#include "core/base/expected.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::codec {

/// A mesh with texture coordinates, one position and one coordinate per vertex.
struct TexturedTriangles {
    std::vector<Eigen::Vector3f> positions;  // [m]
    std::vector<Eigen::Vector2f> uvs;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Ids of the attributes in the Draco stream, as KHR_draco_mesh_compression names them.
inline constexpr std::uint32_t kDracoPositionId = 0;
inline constexpr std::uint32_t kDracoUvId = 1;

struct TexturedCodecOptions {
    int position_bits = 14;  // over the longest side of the mesh: 2 m in steps of 0.12 mm
    int uv_bits = 14;        // a sixteenth of a texel at 1024
    int speed = 3;           // Draco's: 0 smallest and slowest, 10 fastest
};

/// Encodes for files that other programs read: with Draco's own encoder. Vertices and triangles are
/// renumbered; vertices that no triangle uses and triangles without three different vertices
/// disappear. Vertices of one place but different texture coordinates are coded as one place.
/// Deterministic. kInvalidData for a mesh without any valid triangle, different numbers of
/// positions and coordinates, and values that are not finite.
Expected<std::vector<std::uint8_t>> encode_textured(const TexturedTriangles& mesh,
                                                    const TexturedCodecOptions& options);

/// Decodes what `encode_textured` wrote: for the counts and bounds of the decoded mesh, which
/// containers state. Not for untrusted input.
Expected<TexturedTriangles> decode_textured(std::span<const std::uint8_t> bytes);

}  // namespace atrium::codec
