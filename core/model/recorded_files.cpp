#include "core/model/recorded_files.hpp"

#include "core/model/material_file.hpp"

#include <assimp/IOStream.hpp>

#include <algorithm>
#include <system_error>
#include <vector>

namespace atrium::model {
namespace {

bool is_file(const std::filesystem::path& path) {
    std::error_code failure;
    return std::filesystem::is_regular_file(path, failure);
}

}  // namespace

// Null if too many files are noted already.
RecordedFiles::Noted* RecordedFiles::note(const char* file) const {
    const std::filesystem::path path = std::filesystem::path(file).lexically_normal();
    const auto known = files_.find(path);
    if (known != files_.end()) return &known->second;
    if (files_.size() >= kMaxFiles) return nullptr;
    return &files_.emplace(path, Noted{file_stamp(path), {}}).first->second;
}

// Assimp asks for the path that the model names, behind the model's folder, and for parts of it,
// which may be folders.
std::string RecordedFiles::found(const char* file) const {
    const std::string name = last_name_of(file);
    if (name.empty() || is_file(file)) return file;
    const std::filesystem::path beside = file_beside(model_, file);
    return (beside.empty() ? model_.parent_path() / name : beside).string();
}

bool RecordedFiles::Exists(const char* file) const {
    const std::string name = found(file);
    note(name.c_str());
    return is_file(name);
}

Assimp::IOStream* RecordedFiles::Open(const char* file, const char* mode) {
    const std::string name = found(file);
    Noted* noted = note(name.c_str());
    if (!is_file(name)) return nullptr;  // a folder would open, and fail to be read
    Assimp::IOStream* stream = DefaultIOSystem::Open(name.c_str(), mode);
    if (stream == nullptr || noted == nullptr || noted->fingerprint.is_known()) return stream;
    // Assimp opens a file several times: the first time counts
    std::vector<std::uint8_t> bytes(std::min<std::uintmax_t>(stream->FileSize(), max_bytes_));
    bytes.resize(stream->Read(bytes.data(), 1, bytes.size()));
    stream->Seek(0, aiOrigin_SET);
    noted->fingerprint = fingerprint_of(bytes);
    return stream;
}

FilesRead RecordedFiles::read() const {
    FilesRead read;
    std::vector<Fingerprint> opened;
    for (const auto& [file, noted] : files_) {
        read.files.emplace_back(file, noted.stamp);
        if (noted.fingerprint.is_known()) opened.push_back(noted.fingerprint);
    }
    read.fingerprint = fingerprint_of(std::move(opened));
    return read;
}

}  // namespace atrium::model
