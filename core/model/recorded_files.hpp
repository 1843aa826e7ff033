#pragma once

#include "core/base/fingerprint.hpp"

#include <assimp/DefaultIOSystem.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>

namespace atrium::model {

/// Opens files for Assimp and notes which ones, with their fingerprints. Private to core/model.
class RecordedFiles : public Assimp::DefaultIOSystem {
public:
    /// The bytes of a file beyond `max_bytes` do not count for its fingerprint.
    explicit RecordedFiles(std::uintmax_t max_bytes) : max_bytes_(max_bytes) {}

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

    std::uintmax_t max_bytes_;
    mutable std::map<std::filesystem::path, Noted> files_;
};

}  // namespace atrium::model
