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

/// Reads the streams that EdgebreakerWriter writes: of Draco's bitstream 2.2
/// (https://google.github.io/draco/spec/), edgebreaker with standard symbols (Rossignac, 1999), a
/// closed surface, one attribute of quantised positions, each predicted by one parallelogram.
///
/// What it reads is what Draco's decoder makes of the stream, to the bit. Where it differs: the
/// topology comes from a boundary that is linked by vertices, which has no search in it, and
/// predictions are added to residuals in floats, four lanes at once, exact as long as coordinates
/// have 21 bits at most. Memory is kept from mesh to mesh. Of the entropy coders, those of plain
/// bits are here, the others are the library's.
class EdgebreakerReader {
public:
    /// Replaces `out` by the mesh, with finite coordinates within `limits`. False, with anything in
    /// `out`, where the stream is another one, damaged, or beyond `limits`: Draco's decoder may
    /// know more. Counts are held against `limits` and the number of bytes before memory is
    /// allocated for them. May throw what Draco and the allocation of memory throw.
    bool read(std::span<const std::uint8_t> bytes,
              const MeshLimits& limits,
              geometry::TriangleMesh& out);

private:
    using Corner = EdgebreakerTopology::Corner;
    using Position = Eigen::Array4f;  // in steps of the grid; the last one is 0

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
    std::vector<Position> residuals_;  // in the order in which PositionWalk meets the vertices
    std::vector<Position> positions_;  // of each vertex
    std::int32_t lowest_ = 0;          // of all coordinates of all positions
    std::int32_t highest_ = 0;
    std::vector<std::uint8_t> seen_vertices_;
    std::vector<std::uint8_t> seen_triangles_;
    std::vector<Corner> stack_;
};

}  // namespace atrium::codec
