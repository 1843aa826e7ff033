#include "core/base/fingerprint.hpp"

#include "core/base/fnv1a.hpp"
#include "core/base/readable.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <system_error>

namespace atrium {

Fingerprint fingerprint_of(std::span<const std::uint8_t> bytes) {
    return {bytes.size(), fnv1a(bytes)};
}

Fingerprint fingerprint_of(std::vector<Fingerprint> files) {
    if (files.empty()) return {};
    if (files.size() == 1) return files.front();
    std::ranges::sort(
        files, {}, [](const Fingerprint& file) { return std::pair(file.hash, file.num_bytes); });
    Fingerprint sum;
    Fnv1a hash;
    for (const Fingerprint& file : files) {
        sum.num_bytes += file.num_bytes;
        hash.add(file.num_bytes);
        hash.add(file.hash);
    }
    sum.hash = hash.value();
    return sum;
}

Fingerprint fingerprint_of(const std::filesystem::path& file, std::uintmax_t max_bytes) {
    if (!check_readable(file)) return {};  // a pipe would block
    std::error_code failure;
    const std::uintmax_t num_bytes = std::filesystem::file_size(file, failure);
    if (failure || num_bytes > max_bytes) return {};
    std::vector<std::uint8_t> bytes(num_bytes);
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(num_bytes));
    if (static_cast<std::uintmax_t>(stream.gcount()) != num_bytes) return {};
    return fingerprint_of(bytes);
}

std::uint64_t file_stamp(const std::filesystem::path& file) {
    struct stat status {};
    if (stat(file.c_str(), &status) != 0) return 0;
    Fnv1a stamp;
    for (const auto value : {status.st_dev, status.st_ino}) stamp.add(value);
    stamp.add(static_cast<std::uint64_t>(status.st_size));
    for (const auto& time : {status.st_mtim, status.st_ctim}) {
        stamp.add(static_cast<std::uint64_t>(time.tv_sec));
        stamp.add(static_cast<std::uint64_t>(time.tv_nsec));
    }
    return stamp.value();
}

bool FilesRead::have_changed() const {
    return std::ranges::any_of(
        files, [](const auto& file) { return file_stamp(file.first) != file.second; });
}

}  // namespace atrium
