#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

namespace atrium {

/// Tells whether two hosts have the same bytes in a file. Not collision-resistant against an
/// attacker.
struct Fingerprint {
    std::uint64_t num_bytes = 0;
    std::uint64_t hash = 0;  // FNV-1a; 0: unknown

    bool is_known() const { return hash != 0; }
    bool operator==(const Fingerprint&) const = default;
};

Fingerprint fingerprint_of(std::span<const std::uint8_t> bytes);
/// The fingerprint of several files: that of a single one, else a sum that does not depend on their
/// order and names. Unknown without files.
Fingerprint fingerprint_of(std::vector<Fingerprint> files);
/// The fingerprint of a file; unknown if it cannot be read or has more than `max_bytes`.
Fingerprint fingerprint_of(const std::filesystem::path& file, std::uintmax_t max_bytes);

/// Changes whenever the file is written or replaced, as far as the file system notes it (device,
/// inode, size, times of change). 0: the file is not there.
std::uint64_t file_stamp(const std::filesystem::path& file);

/// What was read from a file and the files that it names.
struct FilesRead {
    Fingerprint fingerprint;
    /// With the stamps from before the reading. Also files that were looked for and are not there.
    std::vector<std::pair<std::filesystem::path, std::uint64_t>> files;

    /// True if a file has changed since, has come or is gone. Asks the disk.
    bool have_changed() const;
};

}  // namespace atrium
