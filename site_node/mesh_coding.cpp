#include "site_node/mesh_coding.hpp"

#include <chrono>

namespace atrium::site_node {

MeshCoding::MeshCoding(std::size_t num_meshes, const codec::MeshCodecOptions& options)
    : options_(options), meshes_(num_meshes) {}

void MeshCoding::clear() {
    for (Mesh& mesh : meshes_) {
        mesh.draco.clear();
        mesh.result = {};
        mesh.milliseconds = 0.0;
    }
}

void MeshCoding::encode(std::size_t index,
                        const geometry::TriangleMesh& mesh,
                        std::span<const geometry::CalibratedCamera> cameras) {
    const auto begin = std::chrono::steady_clock::now();
    Mesh& coded = meshes_[index];
    codec::MeshCodecOptions options = options_;
    if (options.position_bits == 0) options.position_bits = codec::position_bits_for(mesh, cameras);
    coded.result = coded.encoder.encode(mesh, options, coded.draco);
    coded.milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

Expected<void> MeshCoding::result() const {
    for (const Mesh& mesh : meshes_) {
        if (!mesh.result) return tl::unexpected(mesh.result.error());
    }
    return {};
}

double MeshCoding::milliseconds() const {
    double sum = 0.0;
    for (const Mesh& mesh : meshes_) sum += mesh.milliseconds;
    return sum;
}

}  // namespace atrium::site_node
