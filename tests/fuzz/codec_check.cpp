#include "tests/fuzz/codec_check.hpp"

#include "core/codec/draco_reader.hpp"
#include "core/codec/edgebreaker_reader.hpp"
#include "core/codec/mask_codec.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/codec/texture_codec.hpp"
#include "tests/support/shapes/decode_mesh.hpp"

#include <algorithm>

namespace atrium::test {

namespace {

constexpr codec::MeshLimits kMeshLimits{.max_triangles = 20'000, .max_vertices = 20'000};

// If Atrium's reader accepts a stream, Draco's must accept it too, with the same mesh.
std::string check_own_reader(std::span<const std::uint8_t> bytes) {
    geometry::TriangleMesh mesh;
    if (!codec::EdgebreakerReader().read(bytes, kMeshLimits, mesh)) return "";
    geometry::TriangleMesh expected;
    if (!codec::read_with_draco(bytes, kMeshLimits, expected)) return "Draco refuses it";
    if (mesh.triangles != expected.triangles) return "Draco reads other triangles";
    if (mesh.vertices != expected.vertices) return "Draco reads other vertices";
    return "";
}

}  // namespace

std::string check_mesh_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    const codec::MeshLimits& limits = kMeshLimits;
    if (std::string wrong = check_own_reader(bytes); !wrong.empty()) return wrong;
    const auto mesh = test::decode_mesh(bytes, limits);
    was_accepted = mesh.has_value();
    if (!mesh) return mesh.error().kind == ErrorKind::kInvalidData ? "" : "another kind of error";
    if (mesh->vertices.size() > limits.max_vertices ||
        mesh->triangles.size() > limits.max_triangles)
        return "more than the limits allow";
    for (const Eigen::Vector3d& vertex : mesh->vertices) {
        if (!(vertex.cwiseAbs().maxCoeff() <= limits.max_coordinate_m)) return "a coordinate";
    }
    for (const auto& triangle : mesh->triangles) {
        if (*std::max_element(triangle.begin(), triangle.end()) >= mesh->vertices.size())
            return "an index";
    }
    return "";
}

std::string check_mask_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    image::Mask mask;
    was_accepted = codec::decode_mask(bytes, mask).has_value();
    if (!was_accepted) return "";
    if (!codec::is_texture_size(mask.width, mask.height)) return "a size";
    if (mask.data.size() !=
        static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height))
        return "not as many pixels as its size says";
    for (const std::uint8_t value : mask.data) {
        if (value != 0 && value != 255) return "a value";
    }
    std::vector<std::uint8_t> again;
    codec::encode_mask(mask, again);
    image::Mask back;
    if (!codec::decode_mask(again, back) || back.data != mask.data) return "another mask again";
    return "";
}

std::string check_texture_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    was_accepted = false;
    if (bytes.size() < 2) return "";
    const std::size_t num_mask =
        std::min<std::size_t>(bytes[0] | std::size_t{bytes[1]} << 8, bytes.size() - 2);
    const auto mask_bytes = bytes.subspan(2, num_mask);
    image::Mask mask;
    // the limits of a texture bound its cost; a fuzzer needs less
    constexpr int kMostPixels = 1 << 16;
    if (codec::decode_mask(mask_bytes, mask) && mask.width * mask.height > kMostPixels) return "";
    codec::TextureDecoder decoder;
    codec::DecodedTexture texture;
    was_accepted = decoder.decode(bytes.subspan(2 + num_mask), mask_bytes, texture).has_value();
    if (!was_accepted) return "";
    if (texture.width != mask.width || texture.height != mask.height) return "a size";
    if (texture.rgba.size() != 4 * mask.data.size()) return "not as many pixels as its size says";
    for (std::size_t i = 0; i < mask.data.size(); ++i) {
        if (texture.rgba[4 * i + 3] != mask.data[i]) return "alpha is not the mask";
    }
    return "";
}

}  // namespace atrium::test
