#pragma once

#include "core/base/expected.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::site_node {

/// Codes the mesh of a site, or those of its regions, each as a task of its own: different tasks
/// may run at the same time. Keeps its memory from metaframe to metaframe.
class MeshCoding {
public:
    MeshCoding(std::size_t num_meshes, const codec::MeshCodecOptions& options);

    std::size_t num_meshes() const { return meshes_.size(); }

    /// All meshes are empty.
    void clear();

    /// Codes mesh `index`. With position_bits 0 in the options, codec::position_bits_for chooses
    /// them from the cameras of the whole site.
    void encode(std::size_t index,
                const geometry::TriangleMesh& mesh,
                std::span<const geometry::CalibratedCamera> cameras);

    /// The Draco stream of mesh `index`; empty for an empty mesh. May be moved from.
    std::vector<std::uint8_t>& draco(std::size_t index) { return meshes_[index].draco; }

    /// The first failure.
    Expected<void> result() const;
    /// Processor time of all meshes [ms].
    double milliseconds() const;

private:
    struct Mesh {
        codec::MeshEncoder encoder;
        std::vector<std::uint8_t> draco;
        Expected<std::size_t> result;
        double milliseconds = 0.0;
    };
    codec::MeshCodecOptions options_;
    std::vector<Mesh> meshes_;
};

}  // namespace atrium::site_node
