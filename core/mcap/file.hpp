#pragma once

#include "core/base/expected.hpp"
#include "core/mcap/records.hpp"
#include "core/mcap/writer.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace atrium::mcap {

/// The messages of one chunk, by log time; equal times in the order of the file.
struct Chunk {
    Bytes records;
    std::vector<Message> messages;  // their data is in `records`
};

/// Reads an MCAP file of chunks, compressed with zstd, lz4 or not at all. Its bytes may be hostile:
/// every length is checked, and a chunk takes at most 256 MiB. Thread-safe after `open`.
class File {
public:
    /// kNotFound if it is missing, kInvalidData if it is no MCAP file or has no whole chunk. A file
    /// without its summary, because its writer was killed or still writes, is searched for chunks.
    static Expected<File> open(const std::filesystem::path& file);

    const Contents& contents() const { return contents_; }
    /// Why the file had to be searched: empty for a complete file.
    const std::string& fault() const { return fault_; }
    /// Chunks that were found damaged in that search, and left out.
    std::size_t num_damaged_chunks() const { return num_damaged_chunks_; }
    bool is_being_written() const { return is_being_written_; }

    /// kInvalidData if the chunk is damaged; the message names file and chunk.
    Expected<Chunk> read(std::size_t chunk) const;

    const std::filesystem::path& path() const { return path_; }

private:
    Expected<bool> read_summary();

    std::filesystem::path path_;
    Descriptor descriptor_{-1};
    Contents contents_;
    std::string fault_;
    std::size_t num_damaged_chunks_ = 0;
    bool is_being_written_ = false;
};

}  // namespace atrium::mcap
