#pragma once

#include "core/base/expected.hpp"
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
    std::string fault;                   // why it ended earlier
    std::size_t num_damaged_chunks = 0;  // left out
};

/// Reads from the start of the file up to the end of its data, or up to the first record that is
/// cut off. Leaves out chunks that are damaged. kInvalidData if `file` (for the message) is no MCAP
/// file.
Expected<Scan> scan(int descriptor, const std::filesystem::path& file);

/// The decompressed records of a chunk, checked by its CRC.
Expected<Bytes> read_records(int descriptor, const ChunkIndex& chunk);

/// The messages in the records of a chunk. Other records in it are left out.
Expected<std::vector<Message>> messages_of(std::span<const std::byte> records);

/// Reads `size` bytes at `offset`. kInvalidData if the file ends before.
Expected<Bytes> read_at(int descriptor, std::uint64_t offset, std::uint64_t size);

}  // namespace atrium::mcap
