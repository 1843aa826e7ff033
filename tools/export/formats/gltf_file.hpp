#pragma once

#include "core/base/expected.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace atrium::exporting {

/// Builds a binary glTF 2.0 file: JSON, and one buffer in memory.
class GltfFile {
public:
    using Json = nlohmann::ordered_json;

    GltfFile();

    /// Adds bytes as a bufferView, aligned to 4 bytes. `target`: ARRAY_BUFFER (34962),
    /// ELEMENT_ARRAY_BUFFER (34963) or 0. Returns its index.
    int add_view(std::span<const std::uint8_t> bytes, int target = 0);
    /// Adds to an array of the JSON; returns the index.
    int add(const char* array, Json value);
    /// An accessor of floats with `num_components` each, with bounds. Adds its bufferView.
    int add_floats(std::span<const float> values, int num_components, int target = 0);

    Json& json() { return json_; }
    std::size_t num_bytes() const { return buffer_.size(); }
    /// Writes the .glb as a whole and returns its size. Fails as OutputFile, or with kInvalidData
    /// if the file would exceed 4 GB.
    Expected<std::uint64_t> write(const std::filesystem::path& file);

private:
    Json json_;
    std::vector<std::uint8_t> buffer_;
};

}  // namespace atrium::exporting
