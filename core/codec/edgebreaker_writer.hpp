#pragma once

#include "core/codec/edgebreaker.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace draco {
class EncoderBuffer;
}

namespace atrium::codec {

/// Writes Draco's bitstream 2.2 of closed meshes: edgebreaker with standard symbols, one attribute
/// of quantised positions, each predicted by the parallelogram of the triangle next to it.
///
/// The bytes are those that Draco's own encoder writes at the same speed, in a third of its time:
/// that a mesh has to be closed spares most of the search for neighbours, and memory is kept from
/// mesh to mesh. The entropy coders are the library's, but for plain bits.
class EdgebreakerWriter {
public:
    /// Draco's speeds with this kind of prediction.
    static constexpr bool takes_speed(int speed) { return speed >= 2 && speed <= 7; }

    /// Appends the stream of `mesh` to `out`. The vertices are finite as floats; `position_bits`
    /// and `speed` as in MeshCodecOptions, `takes_speed`. False, and `out` as it was, if the mesh
    /// is not closed and 2-manifold as ClosedMesh wants it, has two triangles with the same
    /// vertices, floats cannot hold its size or that of a step, or Draco cannot code the residuals.
    /// May throw what Draco and the allocation of memory throw.
    bool write(const geometry::TriangleMesh& mesh,
               int position_bits,
               int speed,
               draco::EncoderBuffer& out);

private:
    using Position = std::array<std::int32_t, 3>;  // in steps of the grid

    bool quantise(const geometry::TriangleMesh& mesh, int position_bits);
    void find_residuals();
    void add_residual(const Position& position, const Position& prediction);
    Position predict(Gate gate) const;
    void write_connectivity(draco::EncoderBuffer& out);
    void write_symbols(draco::EncoderBuffer& out);
    bool write_tagged_residuals(draco::EncoderBuffer& out);
    bool write_residuals(int speed, draco::EncoderBuffer& out);
    bool write_positions(int position_bits, int speed, draco::EncoderBuffer& out);

    Surface surface_;
    EdgebreakerOrder order_;
    std::vector<Eigen::Vector3f> floats_;
    std::vector<Position> positions_;  // of each vertex
    std::array<float, 3> origin_m_{};  // lowest of each coordinate
    float range_m_ = 1.0F;             // of the coordinate with the longest
    std::int32_t lowest_ = 0;          // of all coordinates of all positions
    std::int32_t highest_ = 0;
    std::uint32_t last_vertex_ = 0;         // whose residual was added last
    std::vector<std::uint32_t> residuals_;  // three per vertex, sign in the lowest bit
    std::vector<std::uint32_t> lengths_;    // in bits: of the longest residual of each vertex
    std::vector<std::uint8_t> bits_;
};

}  // namespace atrium::codec
