#pragma once

#include "core/base/fingerprint.hpp"

#include <assimp/DefaultIOSystem.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

namespace atrium::model {

/// Opens files for Assimp and notes which ones, with their fingerprints. Files that a model names
/// are found as `file_beside` finds them. Private to core/model.
class RecordedFiles : public Assimp::DefaultIOSystem {
public:
    /// The bytes of a file beyond `max_bytes` do not count for its fingerprint.
    RecordedFiles(std::filesystem::path model, std::uintmax_t max_bytes)
        : model_(std::move(model)), max_bytes_(max_bytes) {}

    bool Exists(const char* file) const override;
    Assimp::IOStream* Open(const char* file, const char* mode) override;
    FilesRead read() const;

private:
    struct Noted {
        std::uint64_t stamp = 0;
        Fingerprint fingerprint;  // unknown: not opened
    };
    static constexpr std::size_t kMaxFiles = 256;
    Noted* note(const char* file) const;

    std::string found(const char* file) const;

    std::filesystem::path model_;
    std::uintmax_t max_bytes_;
    mutable std::map<std::filesystem::path, Noted> files_;
};

}  // namespace atrium::model
