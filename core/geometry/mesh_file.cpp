#include "core/geometry/mesh_file.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace atrium::geometry {
namespace {

static_assert(std::endian::native == std::endian::little, "all formats here are little-endian");

template <typename T>
void append_bytes(std::string& out, const T& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string as_ply(const TriangleMesh& mesh) {
    std::string out =
        "ply\nformat binary_little_endian 1.0\ncomment metres, +Z up\nelement vertex " +
        std::to_string(mesh.vertices.size()) +
        "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
        std::to_string(mesh.triangles.size()) +
        "\nproperty list uchar int vertex_indices\nend_header\n";
    out.reserve(out.size() + 24 * mesh.vertices.size() + 13 * mesh.triangles.size());
    for (const Eigen::Vector3d& p : mesh.vertices) {
        for (const double c : {p.x(), p.y(), p.z()}) append_bytes(out, c);
    }
    for (const auto& triangle : mesh.triangles) {
        append_bytes(out, std::uint8_t{3});
        for (const std::uint32_t v : triangle) append_bytes(out, v);
    }
    return out;
}

std::string as_obj(const TriangleMesh& mesh) {
    std::string out = "# metres, +Z up\n";
    std::array<char, 32> digits{};
    const auto append = [&](char before, auto value) {
        out += before;
        const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
        out.append(digits.data(), end);
    };
    for (const Eigen::Vector3d& p : mesh.vertices) {
        out += 'v';
        for (const double c : {p.x(), p.y(), p.z()}) append(' ', c);
        out += '\n';
    }
    for (const auto& triangle : mesh.triangles) {
        out += 'f';
        for (const std::uint32_t v : triangle) append(' ', std::uint64_t{v} + 1);
        out += '\n';
    }
    return out;
}

std::string base64(const std::string& bytes) {
    constexpr const char* kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t k = 0; k < 3; ++k) {
            word = (word << 8) | (k < n ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k)
            out += k <= n ? kDigits[(word >> (18 - 6 * k)) & 63u] : '=';
    }
    return out;
}

struct GltfParts {
    nlohmann::json document;
    std::string buffer;
};

GltfParts as_gltf_parts(const TriangleMesh& mesh) {
    GltfParts parts;
    constexpr int kFloat = 5126;
    constexpr int kUnsignedInt = 5125;
    constexpr int kVertices = 34962;
    constexpr int kIndices = 34963;
    parts.document["asset"] = {{"version", "2.0"}, {"generator", "atrium"}};
    parts.document["scene"] = 0;
    if (mesh.empty()) {  // glTF has no empty accessors
        parts.document["scenes"] = nlohmann::json::array({nlohmann::json::object()});
        return parts;
    }
    std::array<float, 3> low{};
    std::array<float, 3> high{};
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    for (const Eigen::Vector3d& p : mesh.vertices) {
        for (int i = 0; i < 3; ++i) {
            const auto c = static_cast<float>(p[i]);
            append_bytes(parts.buffer, c);
            low[static_cast<std::size_t>(i)] = std::min(low[static_cast<std::size_t>(i)], c);
            high[static_cast<std::size_t>(i)] = std::max(high[static_cast<std::size_t>(i)], c);
        }
    }
    const std::size_t index_begin = parts.buffer.size();
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t v : triangle) append_bytes(parts.buffer, v);
    }
    const std::size_t index_bytes = parts.buffer.size() - index_begin;
    nlohmann::json& doc = parts.document;
    const double half = std::sqrt(0.5);
    doc["scenes"] = nlohmann::json::array({{{"nodes", nlohmann::json::array({0})}}});
    const auto z_up_to_y_up = nlohmann::json::array({-half, 0.0, 0.0, half});
    doc["nodes"] = nlohmann::json::array({{{"mesh", 0}, {"rotation", z_up_to_y_up}}});
    nlohmann::json primitive = {{"indices", 1}, {"mode", 4}};
    primitive["attributes"]["POSITION"] = 0;
    doc["meshes"] = nlohmann::json::array({{{"primitives", nlohmann::json::array({primitive})}}});
    doc["buffers"] = nlohmann::json::array({{{"byteLength", parts.buffer.size()}}});
    doc["bufferViews"] = nlohmann::json::array(
        {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", index_begin}, {"target", kVertices}},
         {{"buffer", 0},
          {"byteOffset", index_begin},
          {"byteLength", index_bytes},
          {"target", kIndices}}});
    doc["accessors"] = nlohmann::json::array({{{"bufferView", 0},
                                               {"componentType", kFloat},
                                               {"count", mesh.vertices.size()},
                                               {"type", "VEC3"},
                                               {"min", low},
                                               {"max", high}},
                                              {{"bufferView", 1},
                                               {"componentType", kUnsignedInt},
                                               {"count", 3 * mesh.triangles.size()},
                                               {"type", "SCALAR"}}});
    return parts;
}

std::string as_gltf(const TriangleMesh& mesh) {
    GltfParts parts = as_gltf_parts(mesh);
    if (!mesh.empty()) {
        parts.document["buffers"][0]["uri"] =
            "data:application/octet-stream;base64," + base64(parts.buffer);
    }
    return parts.document.dump();
}

std::string as_glb(const TriangleMesh& mesh) {
    GltfParts parts = as_gltf_parts(mesh);
    std::string text = parts.document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string out = "glTF";
    const std::size_t buffer_chunk =
        parts.buffer.empty() ? 0 : 8 + parts.buffer.size();  // a multiple of 4 already
    append_bytes(out, std::uint32_t{2});
    append_bytes(out, static_cast<std::uint32_t>(12 + 8 + text.size() + buffer_chunk));
    append_bytes(out, static_cast<std::uint32_t>(text.size()));
    out += "JSON" + text;
    if (buffer_chunk > 0) {
        append_bytes(out, static_cast<std::uint32_t>(parts.buffer.size()));
        out += std::string("BIN\0", 4) + parts.buffer;
    }
    return out;
}

using Encoder = std::string (*)(const TriangleMesh&);

Encoder encoder_for(const std::filesystem::path& path) {
    std::string suffix = path.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) {
        return static_cast<char>(std::tolower(c));
    });
    if (suffix == ".ply") return as_ply;
    if (suffix == ".obj") return as_obj;
    if (suffix == ".gltf") return as_gltf;
    if (suffix == ".glb") return as_glb;
    return nullptr;
}

}  // namespace

bool is_mesh_path(const std::filesystem::path& path) { return encoder_for(path) != nullptr; }

Expected<void> write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
    const Encoder encode = encoder_for(path);
    if (encode == nullptr) {
        return make_error(ErrorKind::kConfiguration,
                          path.string() + ": unknown mesh format; use .ply, .obj, .gltf or .glb");
    }
    const std::string bytes = encode(mesh);
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) return make_error(ErrorKind::kUnavailable, path.string() + ": cannot be written");
    return {};
}

}  // namespace atrium::geometry
