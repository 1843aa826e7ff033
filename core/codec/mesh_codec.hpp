#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

/// Converts meshes to and from their coded bytes. Does not use the network.
namespace atrium::codec {

struct MeshCodecOptions {
    /// Bits per coordinate, 8..20. Positions are rounded to a cubic grid, whose step is the
    /// longest side of the mesh by 2^bits - 1: 14 bits and 2 m give 0.122 mm. See
    /// position_bits_for.
    int position_bits = 14;
    int speed = 7;  // Draco's: 0 smallest and slowest, 10 fastest; 7 measured as the best trade-off
};

/// Limits on meshes from untrusted senders. One person has about 10,000 triangles.
struct MeshLimits {
    std::uint32_t max_triangles = 400'000;
    std::uint32_t max_vertices = 200'004;
    double max_coordinate_m = 1000.0;  // of |x|, |y|, |z|
};

/// Longest step that position_bits_for allows, in texture pixels. Textures have half as many pixels
/// per side as the pictures that a camera delivers.
constexpr double kStepInTexturePixels = 0.25;

/// Returns the smallest number of bits, 8 to 16, with `step * m <= 2 * kStepInTexturePixels`. Here
/// m is the largest motion in any camera's delivered picture [px] per metre of motion of any vertex
/// of `mesh`, to first order: `f * distance / depth^2` with the larger focal length. Example: a
/// camera at 2.5 m with f = 1000 px has 2.5 mm per pixel and allows steps of 1.25 mm: 11 bits for a
/// person of 1.8 m, with steps of 0.88 mm.
///
/// A vertex thus moves by at most sqrt(3) / 2 steps (half a step per axis), at most 0.44 delivered
/// or 0.22 texture pixels in every camera, except in cameras too near for 16 bits. Vertices behind
/// a camera are ignored; 14 if no camera sees any vertex.
int position_bits_for(const geometry::TriangleMesh& mesh,
                      std::span<const geometry::CalibratedCamera> cameras);

/// Encodes meshes. Reuses its memory from mesh to mesh; use one per thread.
class MeshEncoder {
public:
    MeshEncoder();
    ~MeshEncoder();
    MeshEncoder(MeshEncoder&&) noexcept;
    MeshEncoder& operator=(MeshEncoder&&) noexcept;

    /// Replaces `out` by the Draco stream of `mesh` (edgebreaker connectivity, quantised positions)
    /// and returns its size. An empty mesh gives zero bytes.
    ///
    /// Does not keep the order: vertices and triangles are renumbered, triangles may start at
    /// another corner, unused vertices disappear. Keeps the indexed topology: a closed 2-manifold
    /// mesh stays closed and 2-manifold with the same number of vertices, even if vertices coincide
    /// on the grid. A vertex of several triangle fans becomes one vertex per fan. Triangles that
    /// use a vertex twice disappear. Each coordinate moves by at most half a step plus the rounding
    /// to float (6e-8 of its magnitude).
    ///
    /// EdgebreakerWriter encodes closed 2-manifold meshes at speeds of 2 to 7; Draco's encoder,
    /// which takes three times as long, encodes all others.
    ///
    /// Fails with kInvalidData for indices out of range, values that are not finite, and a mesh
    /// without any valid triangle; with kInternal if Draco or an allocation throws. `out` keeps its
    /// capacity; Draco allocates internally.
    Expected<std::size_t> encode(const geometry::TriangleMesh& mesh,
                                 const MeshCodecOptions& options,
                                 std::vector<std::uint8_t>& out);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Decodes the streams of MeshEncoder. Reuses its memory from mesh to mesh; use one per thread.
class MeshDecoder {
public:
    MeshDecoder();
    ~MeshDecoder();
    MeshDecoder(MeshDecoder&&) noexcept;
    MeshDecoder& operator=(MeshDecoder&&) noexcept;

    /// Replaces `out` by the mesh in `bytes`. Safe for untrusted input: reads only the kind of
    /// stream that MeshEncoder writes, and checks declared counts against `limits` before it
    /// allocates memory. The mesh has finite coordinates within `limits` and indices in range; it
    /// need not be closed or make sense. Zero bytes are the empty mesh. Fails with kInvalidData;
    /// `out` is then undefined.
    ///
    /// EdgebreakerReader decodes closed meshes of speeds 2 to 7, Draco's decoder all others. Both
    /// give the same mesh.
    Expected<void> decode(std::span<const std::uint8_t> bytes,
                          const MeshLimits& limits,
                          geometry::TriangleMesh& out);

    /// The same for several meshes one after another in `bytes`, of `sizes` bytes each: replaces
    /// `out` by all of them as one mesh, within `limits` as a whole. No sizes: it is one mesh.
    Expected<void> decode(std::span<const std::uint8_t> bytes,
                          std::span<const std::uint32_t> sizes,
                          const MeshLimits& limits,
                          geometry::TriangleMesh& out);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace atrium::codec
