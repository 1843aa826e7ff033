#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"
#include "core/mcap/compression.hpp"
#include "core/mcap/records.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace atrium::mcap {

/// Writes an MCAP file: chunks compressed with zstd, message indexes, and at the end a summary.
///
/// Messages are collected in *lanes*, each of which becomes chunks of its own: a reader that needs
/// only the messages of one lane then leaves the others out. What is not in a flushed chunk is lost
/// if the process is killed; all else can be read. The file is locked (flock) while it is written.
/// One thread at a time.
class Writer {
public:
    /// Creates `file`. Fails if it exists, or as `cannot_write`.
    static Expected<Writer> create(const std::filesystem::path& file, std::size_t num_lanes);

    /// Writes them into the file at once and returns their number.
    Expected<std::uint16_t> add(const Schema& schema);
    Expected<std::uint16_t> add(const Channel& channel);
    Expected<void> add(Metadata metadata);

    /// Copies the message into the lane's chunk.
    void write(std::size_t lane, const Message& message) { lanes_[lane].add(message); }
    std::size_t lane_bytes(std::size_t lane) const { return lanes_[lane].records.size(); }

    /// Writes the lane's chunk, if it holds something. After an error (disk full) the file ends
    /// behind the last whole chunk and the messages of this one are lost.
    Expected<void> flush(std::size_t lane);
    /// Flushes all lanes and writes the summary, once: nothing may be written afterwards. Without
    /// it, or if it fails, the file lacks only the summary: `File::open` finds the chunks without.
    Expected<void> finish();

    /// Of the file so far.
    std::uint64_t num_bytes() const { return end_; }
    const Contents& contents() const { return contents_; }
    /// Messages of chunks that could not be written, by channel.
    const std::map<std::uint16_t, std::uint64_t>& lost() const { return lost_; }

private:
    Writer(std::filesystem::path file, Descriptor descriptor, std::size_t num_lanes);
    Expected<void> append(std::span<const std::byte> bytes);
    friend Expected<void> repair(const std::filesystem::path& file);

    std::filesystem::path file_;
    Descriptor descriptor_;
    std::uint64_t end_ = 0;
    Contents contents_;
    std::vector<ChunkBuilder> lanes_;
    ZstdCompressor compressor_;
    Bytes buffer_;
    std::map<std::uint16_t, std::uint64_t> lost_;
    bool is_finished_ = false;
};

/// Completes a file that was cut off: removes what is behind the last whole chunk and writes the
/// summary. kUnavailable if another process is writing it; kInvalidData if it has no whole chunk,
/// or messages outside of chunks, which would be lost.
Expected<void> repair(const std::filesystem::path& file);

}  // namespace atrium::mcap
