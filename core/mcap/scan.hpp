#pragma once

#include "core/base/expected.hpp"
#include "core/mcap/compression.hpp"
#include "core/mcap/records.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

/// Finds what is in a file without its summary. Private to core/mcap.
namespace atrium::mcap {

struct Scan {
    Contents contents;
    std::uint64_t end = 0;               // behind the last whole record that is kept
    bool is_complete = false;            // the data section has its end
    bool is_read = true;                 // false: the disk could not be read
    std::string fault;                   // why it ended earlier
    std::size_t num_damaged_chunks = 0;  // left out
    bool has_loose_messages = false;     // outside of chunks: not read
};

/// Reads from the start of the file up to the end of its data, or up to the first record that is
/// cut off. Leaves out chunks that are damaged. kInvalidData if `file` (for the message) is no MCAP
/// file.
Expected<Scan> scan(int descriptor, const std::filesystem::path& file);

/// Longest chunk record that is read: no more memory is taken for one, whatever a file says.
inline constexpr std::uint64_t kMaxChunkRecordBytes = kMaxChunkBytes + (std::uint64_t{1} << 20U);

/// A chunk, as its own record says; without its message indexes.
struct ReadChunk {
    ChunkIndex index;
    Bytes records;  // decompressed, checked by the CRC
};
/// kInvalidData if there is no whole chunk record of `length` bytes, head included.
Expected<ReadChunk> read_chunk_at(int descriptor, std::uint64_t offset, std::uint64_t length);

/// The messages in the records of a chunk. Other records in it are left out.
Expected<std::vector<Message>> messages_of(std::span<const std::byte> records);

/// Reads `size` bytes at `offset`. kInvalidData if the file ends before.
Expected<Bytes> read_at(int descriptor, std::uint64_t offset, std::uint64_t size);

}  // namespace atrium::mcap
