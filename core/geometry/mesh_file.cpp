#include "core/geometry/mesh_file.hpp"

#include "core/base/write_check.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <utility>

namespace atrium::geometry {
namespace {

static_assert(std::endian::native == std::endian::little, "all formats here are little-endian");

template <typename T>
void append_bytes(std::string& out, const T& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

using Normals = std::span<const Eigen::Vector3f>;

Eigen::Vector3f unit(const Eigen::Vector3f& normal) {
    return normal.isZero() ? Eigen::Vector3f::UnitZ() : normal;
}

std::string as_ply(const TriangleMesh& mesh, Normals normals) {
    std::string out =
        "ply\nformat binary_little_endian 1.0\ncomment metres, +Z up\nelement vertex " +
        std::to_string(mesh.vertices.size()) +
        "\nproperty double x\nproperty double y\nproperty double z" +
        (normals.empty() ? "" : "\nproperty float nx\nproperty float ny\nproperty float nz") +
        "\nelement face " + std::to_string(mesh.triangles.size()) +
        "\nproperty list uchar int vertex_indices\nend_header\n";
    out.reserve(out.size() + 24 * mesh.vertices.size() + 12 * normals.size() +
                13 * mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Eigen::Vector3d& p = mesh.vertices[i];
        for (const double c : {p.x(), p.y(), p.z()}) append_bytes(out, c);
        if (normals.empty()) continue;
        const Eigen::Vector3f n = unit(normals[i]);
        for (const float c : {n.x(), n.y(), n.z()}) append_bytes(out, c);
    }
    for (const auto& triangle : mesh.triangles) {
        append_bytes(out, std::uint8_t{3});
        for (const std::uint32_t v : triangle) append_bytes(out, v);
    }
    return out;
}

std::string as_obj(const TriangleMesh& mesh, Normals normals) {
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
    for (const Eigen::Vector3f& normal : normals) {
        const Eigen::Vector3f n = unit(normal);
        out += "vn";
        for (const float c : {n.x(), n.y(), n.z()}) append(' ', c);
        out += '\n';
    }
    for (const auto& triangle : mesh.triangles) {
        out += 'f';
        for (const std::uint32_t v : triangle) {
            append(' ', std::uint64_t{v} + 1);
            if (normals.empty()) continue;
            out += '/';  // no texture
            append('/', std::uint64_t{v} + 1);
        }
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

// Makes the end of the buffer from `begin` on an accessor and returns its number.
std::size_t add_accessor(GltfParts& parts, std::size_t begin, int target, nlohmann::json accessor) {
    const std::size_t number = parts.document["accessors"].size();
    parts.document["bufferViews"].push_back({{"buffer", 0},
                                             {"byteOffset", begin},
                                             {"byteLength", parts.buffer.size() - begin},
                                             {"target", target}});
    accessor["bufferView"] = number;
    parts.document["accessors"].push_back(std::move(accessor));
    return number;
}

constexpr int kFloat = 5126;
constexpr int kUnsignedInt = 5125;
constexpr int kVertices = 34962;
constexpr int kIndices = 34963;

std::size_t add_positions(GltfParts& parts, const TriangleMesh& mesh) {
    std::array<float, 3> low{};
    std::array<float, 3> high{};
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    const std::size_t begin = parts.buffer.size();
    for (const Eigen::Vector3d& p : mesh.vertices) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto c = static_cast<float>(p[static_cast<Eigen::Index>(i)]);
            append_bytes(parts.buffer, c);
            low[i] = std::min(low[i], c);
            high[i] = std::max(high[i], c);
        }
    }
    return add_accessor(parts,
                        begin,
                        kVertices,
                        {{"componentType", kFloat},
                         {"count", mesh.vertices.size()},
                         {"type", "VEC3"},
                         {"min", low},
                         {"max", high}});
}

std::size_t add_normals(GltfParts& parts, Normals normals) {
    const std::size_t begin = parts.buffer.size();
    for (const Eigen::Vector3f& normal : normals) {
        const Eigen::Vector3f n = unit(normal);
        for (const float c : {n.x(), n.y(), n.z()}) append_bytes(parts.buffer, c);
    }
    return add_accessor(parts,
                        begin,
                        kVertices,
                        {{"componentType", kFloat}, {"count", normals.size()}, {"type", "VEC3"}});
}

std::size_t add_indices(GltfParts& parts, const TriangleMesh& mesh) {
    const std::size_t begin = parts.buffer.size();
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t v : triangle) append_bytes(parts.buffer, v);
    }
    return add_accessor(parts,
                        begin,
                        kIndices,
                        {{"componentType", kUnsignedInt},
                         {"count", 3 * mesh.triangles.size()},
                         {"type", "SCALAR"}});
}

GltfParts as_gltf_parts(const TriangleMesh& mesh, Normals normals) {
    GltfParts parts;
    nlohmann::json& doc = parts.document;
    doc["asset"] = {{"version", "2.0"}, {"generator", "atrium"}};
    doc["scene"] = 0;
    if (mesh.empty()) {  // glTF has no empty accessors
        doc["scenes"] = nlohmann::json::array({nlohmann::json::object()});
        return parts;
    }
    const double half = std::sqrt(0.5);
    const auto z_up_to_y_up = nlohmann::json::array({-half, 0.0, 0.0, half});
    doc["scenes"] = nlohmann::json::array({{{"nodes", nlohmann::json::array({0})}}});
    doc["nodes"] = nlohmann::json::array({{{"mesh", 0}, {"rotation", z_up_to_y_up}}});
    nlohmann::json primitive = {{"mode", 4}};
    primitive["attributes"]["POSITION"] = add_positions(parts, mesh);
    primitive["indices"] = add_indices(parts, mesh);
    if (!normals.empty()) primitive["attributes"]["NORMAL"] = add_normals(parts, normals);
    doc["meshes"] = nlohmann::json::array({{{"primitives", nlohmann::json::array({primitive})}}});
    doc["buffers"] = nlohmann::json::array({{{"byteLength", parts.buffer.size()}}});
    return parts;
}

std::string as_gltf(const TriangleMesh& mesh, Normals normals) {
    GltfParts parts = as_gltf_parts(mesh, normals);
    if (!mesh.empty()) {
        parts.document["buffers"][0]["uri"] =
            "data:application/octet-stream;base64," + base64(parts.buffer);
    }
    return parts.document.dump();
}

std::string as_glb(const TriangleMesh& mesh, Normals normals) {
    GltfParts parts = as_gltf_parts(mesh, normals);
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

using Encoder = std::string (*)(const TriangleMesh&, Normals);

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

Expected<void> write_mesh(const std::filesystem::path& path,
                          const TriangleMesh& mesh,
                          std::span<const Eigen::Vector3f> normals) {
    assert(normals.empty() || normals.size() == mesh.vertices.size());
    const Encoder encode = encoder_for(path);
    if (encode == nullptr) {
        return make_error(ErrorKind::kConfiguration,
                          path.string() + ": unknown mesh format; use .ply, .obj, .gltf or .glb");
    }
    const std::string bytes = encode(mesh, normals);
    errno = 0;
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) return tl::unexpected(cannot_write(path, "write", errno));
    return {};
}

}  // namespace atrium::geometry
