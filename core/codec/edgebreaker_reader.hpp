#pragma once

#include "core/codec/edgebreaker_topology.hpp"
#include "core/codec/mesh_codec.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace draco {
class DecoderBuffer;
}

namespace atrium::codec {

/// Reads the streams of EdgebreakerWriter: Draco bitstream 2.2
/// (https://google.github.io/draco/spec/) with edgebreaker and standard symbols (Rossignac, 1999),
/// a closed surface and one attribute of quantised positions, each predicted by one parallelogram.
///
/// The result equals that of Draco's decoder bit for bit. Differences in the method: the boundary
/// is linked by vertices, which avoids a search, and predictions are added to residuals as floats,
/// four lanes at once, exact for coordinates of at most 21 bits. Reuses its memory from mesh to
/// mesh. Reads plain bits itself; the other entropy coders are Draco's.
class EdgebreakerReader {
public:
    /// Replaces `out` by the mesh, with finite coordinates within `limits`. False, with undefined
    /// `out`, if the stream has another form, is damaged or exceeds `limits`; Draco's decoder may
    /// still read it. Safe for untrusted input: checks counts against `limits` and the number of
    /// bytes before it allocates memory. Throws what Draco and allocation throw.
    bool read(std::span<const std::uint8_t> bytes,
              const MeshLimits& limits,
              geometry::TriangleMesh& out);

private:
    using Corner = EdgebreakerTopology::Corner;
    using Position = Eigen::Array4f;  // in grid steps; the last element is 0

    bool read_topology(draco::DecoderBuffer& in,
                       const MeshLimits& limits,
                       geometry::TriangleMesh& out);
    bool read_handles(draco::DecoderBuffer& in);
    bool read_residuals(draco::DecoderBuffer& in);
    bool read_tagged_residuals(draco::DecoderBuffer& in);
    bool read_untagged_residuals(draco::DecoderBuffer& in);
    bool read_positions(draco::DecoderBuffer& in, std::span<const std::uint32_t> corners);
    bool read_vertices(draco::DecoderBuffer& in,
                       double max_coordinate_m,
                       std::vector<Eigen::Vector3d>& vertices) const;

    CodedTopology coded_;
    EdgebreakerTopology topology_;
    std::vector<HandleEvent> handles_;
    std::vector<std::uint32_t> untagged_;
    std::vector<Position> residuals_;  // in the order in which read_positions reaches the vertices
    std::vector<Position> positions_;  // of each vertex
    std::int32_t lowest_ = 0;          // of all coordinates of all positions
    std::int32_t highest_ = 0;
    std::vector<std::uint8_t> seen_vertices_;
    std::vector<std::uint8_t> seen_triangles_;
    std::vector<Corner> stack_;
};

}  // namespace atrium::codec
