#include "tools/export/formats/gltf_file.hpp"

#include "tools/export/formats/output_file.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace atrium::exporting {
namespace {

constexpr std::uint32_t kMagic = 0x46546C67;  // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;
constexpr int kFloat = 5126;

void put_u32(std::uint32_t value, std::vector<std::uint8_t>& out) {
    for (int shift = 0; shift < 32; shift += 8)
        out.push_back(static_cast<std::uint8_t>(value >> shift));
}

}  // namespace

GltfFile::GltfFile() { json_["asset"]["version"] = "2.0"; }

int GltfFile::add(const char* array, Json value) {
    Json& list = json_[array];
    list.push_back(std::move(value));
    return static_cast<int>(list.size()) - 1;
}

int GltfFile::add_view(std::span<const std::uint8_t> bytes, int target) {
    buffer_.resize((buffer_.size() + 3) / 4 * 4, 0);
    Json view{{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes.size()}};
    if (target != 0) view["target"] = target;
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    return add("bufferViews", std::move(view));
}

int GltfFile::add_floats(std::span<const float> values, int num_components, int target) {
    static constexpr std::array<const char*, 4> kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
    const auto components = static_cast<std::size_t>(num_components);
    std::vector<float> low(components, std::numeric_limits<float>::infinity());
    std::vector<float> high(components, -std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < values.size(); ++i) {
        low[i % components] = std::min(low[i % components], values[i]);
        high[i % components] = std::max(high[i % components], values[i]);
    }
    const int view = add_view(
        {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()}, target);
    return add("accessors",
               {{"bufferView", view},
                {"componentType", kFloat},
                {"count", values.size() / components},
                {"type", kTypes[components - 1]},
                {"min", low},
                {"max", high}});
}

Expected<std::uint64_t> GltfFile::write(const std::filesystem::path& file) {
    buffer_.resize((buffer_.size() + 3) / 4 * 4, 0);
    if (!buffer_.empty()) json_["buffers"] = Json::array({{{"byteLength", buffer_.size()}}});
    std::string text = json_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t total =
        12 + 8 + text.size() + (buffer_.empty() ? 0 : 8 + std::uint64_t{buffer_.size()});
    if (total > std::numeric_limits<std::uint32_t>::max()) {
        return make_error(ErrorKind::kInvalidData,
                          file.string() + ": would exceed 4 GB, the limit of .glb; use --chunk_mb");
    }
    std::vector<std::uint8_t> head;
    for (const std::uint32_t value : {kMagic,
                                      2U,
                                      static_cast<std::uint32_t>(total),
                                      static_cast<std::uint32_t>(text.size()),
                                      kJsonChunk})
        put_u32(value, head);
    auto out = OutputFile::create(file);
    if (!out) return tl::unexpected(out.error());
    if (auto done = out->write(head); !done) return tl::unexpected(done.error());
    if (auto done = out->write(text); !done) return tl::unexpected(done.error());
    if (!buffer_.empty()) {
        head.clear();
        put_u32(static_cast<std::uint32_t>(buffer_.size()), head);
        put_u32(kBinaryChunk, head);
        if (auto done = out->write(head); !done) return tl::unexpected(done.error());
        if (auto done = out->write(buffer_); !done) return tl::unexpected(done.error());
    }
    if (auto done = out->commit(); !done) return tl::unexpected(done.error());
    return total;
}

}  // namespace atrium::exporting
