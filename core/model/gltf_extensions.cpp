#include "core/model/gltf_extensions.hpp"

#include "core/model/model_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>

namespace atrium::model {
namespace {

struct Extension {
    std::string_view name;
    std::string_view cure;
};

constexpr std::array<Extension, 4> kUnread{
    Extension{"KHR_mesh_quantization", "export it with numbers of full size (gltfpack -noq)"},
    Extension{"EXT_meshopt_compression", "export it uncompressed (gltfpack without -c and -cc)"},
    Extension{"KHR_meshopt_compression", "export it uncompressed (gltfpack without -c and -cc)"},
    Extension{"EXT_mesh_gpu_instancing", "export it without instances (gltfpack without -mi)"}};

// The JSON text of a .gltf file, or of the first chunk of a .glb file.
std::string json_of(const std::filesystem::path& file) {
    constexpr std::size_t kHead = 20, kLength = 12;  // bytes, little-endian
    std::ifstream stream(file, std::ios::binary);
    std::string bytes(std::istreambuf_iterator<char>(stream), {});
    if (bytes.size() < kHead || !bytes.starts_with("glTF")) return bytes;
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i)
        length |= std::uint32_t{static_cast<unsigned char>(bytes[kLength + i])} << (8 * i);
    return bytes.substr(kHead, length);
}

}  // namespace

std::string unread_extension(const std::filesystem::path& file) {
    if (!is_gltf(file)) return {};
    const auto json = nlohmann::json::parse(json_of(file), nullptr, /*allow_exceptions=*/false);
    if (!json.is_object()) return {};
    const auto required = json.find("extensionsRequired");
    if (required == json.end() || !required->is_array()) return {};
    for (const auto& [name, cure] : kUnread) {
        for (const auto& entry : *required) {
            if (!entry.is_string() || entry.get_ref<const std::string&>() != name) continue;
            return fmt::format("needs the glTF extension {}, which is not read: {}", name, cure);
        }
    }
    return {};
}

}  // namespace atrium::model
