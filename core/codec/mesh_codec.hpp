#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

/// Between values and the coded bytes that travel; nothing here knows the network.
namespace atrium::codec {

struct MeshCodecOptions {
    /// Bits per coordinate, 8..20. Positions snap to a cubic grid of `quantisation_step_m`: with 14
    /// bits a mesh whose longest side is 2 m has a step of 0.122 mm. See position_bits_for.
    int position_bits = 14;
    int speed = 7;  // Draco's: 0 smallest and slowest, 10 fastest; 7 is the best trade measured
};

/// What MeshDecoder accepts from a stranger. One person is about 10,000 triangles.
struct MeshLimits {
    std::uint32_t max_triangles = 400'000;
    std::uint32_t max_vertices = 200'004;
    double max_coordinate_m = 1000.0;  // of |x|, |y|, |z|
};

/// Side of the grid that positions snap to; the same on all axes, set by the longest side.
double quantisation_step_m(const geometry::TriangleMesh& mesh, const MeshCodecOptions& options);

/// Longest step that position_bits_for allows, in pixels of the textures, which are half as many
/// per side as those that a camera delivers.
constexpr double kStepInTexturePixels = 0.25;

/// Least number of bits, 8 to 16, with which `step * m <= 2 * kStepInTexturePixels`, where m is the
/// most delivered pixels by which any camera sees any vertex of `mesh` move per metre, to first
/// order: `f * distance / depth^2` with the larger focal length. A camera at 2.5 m with f = 1000 px
/// sees 2.5 mm as a pixel and allows steps of 1.25 mm: 11 bits for a person of 1.8 m, in steps of
/// 0.88 mm.
///
/// So no vertex moves by more than sqrt(3) / 2 steps (half a step on each axis), which every camera
/// sees as at most 0.44 delivered (0.22 texture) pixels, unless one is so near that 16 bits do not
/// do. Vertices behind a camera do not count; 14 where no camera sees any.
int position_bits_for(const geometry::TriangleMesh& mesh,
                      std::span<const geometry::CalibratedCamera> cameras);

/// Holds the memory that is reused from mesh to mesh; one per thread.
class MeshEncoder {
public:
    MeshEncoder();
    ~MeshEncoder();
    MeshEncoder(MeshEncoder&&) noexcept;
    MeshEncoder& operator=(MeshEncoder&&) noexcept;

    /// Replaces `out` by the Draco stream of `mesh` (edgebreaker connectivity, quantised positions)
    /// and returns its size. An empty mesh is zero bytes.
    ///
    /// Order is not kept: vertices and triangles are renumbered, a triangle may begin at another of
    /// its corners, unused vertices disappear. Topology is kept as indexed: a closed 2-manifold
    /// mesh comes back closed and 2-manifold with as many vertices, even where vertices coincide on
    /// the grid. A vertex in which several fans of triangles meet comes back as one vertex per fan;
    /// triangles that use a vertex twice disappear. Each coordinate moves by at most half a step
    /// plus the rounding to float (6e-8 of its magnitude).
    ///
    /// Closed 2-manifold meshes at speeds of 2 to 7 are written here (see EdgebreakerWriter), all
    /// others by Draco's encoder, which takes three times as long.
    ///
    /// Fails with kInvalidData on indices out of range, values that are not finite, and a mesh of
    /// which nothing is left. `out` keeps its capacity; Draco itself allocates inside.
    Expected<std::size_t> encode(const geometry::TriangleMesh& mesh,
                                 const MeshCodecOptions& options,
                                 std::vector<std::uint8_t>& out);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// MeshEncoder::encode with memory of its own.
Expected<std::size_t> encode_mesh(const geometry::TriangleMesh& mesh,
                                  const MeshCodecOptions& options,
                                  std::vector<std::uint8_t>& out);

/// The reverse. Holds the memory that is reused from mesh to mesh; one per thread.
class MeshDecoder {
public:
    MeshDecoder();
    ~MeshDecoder();
    MeshDecoder(MeshDecoder&&) noexcept;
    MeshDecoder& operator=(MeshDecoder&&) noexcept;

    /// Replaces `out` by the mesh of `bytes` that anyone may have sent; on failure `out` holds
    /// anything. Only streams of the form that MeshEncoder makes are read; the counts they declare
    /// are held against `limits` before anything is allocated for them. What comes back has finite
    /// coordinates within `limits` and indices in range; that it is closed or makes sense is not
    /// known. Zero bytes are the empty mesh. Fails with kInvalidData.
    ///
    /// Streams of closed meshes at speeds of 2 to 7 are read here (see EdgebreakerReader), all
    /// others by Draco's decoder. Both give the same mesh.
    Expected<void> decode(std::span<const std::uint8_t> bytes,
                          const MeshLimits& limits,
                          geometry::TriangleMesh& out);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// MeshDecoder::decode with memory of its own.
Expected<geometry::TriangleMesh> decode_mesh(std::span<const std::uint8_t> bytes,
                                             const MeshLimits& limits = {});

}  // namespace atrium::codec
