#pragma once

#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "core/mcap/bytes.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

/// The records of an MCAP file (https://mcap.dev/spec), as far as Atrium writes and reads them.
namespace atrium::mcap {

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::uint64_t kRecordHeadBytes = 9;  // opcode and length

enum class Opcode : std::uint8_t {
    kNone = 0x00,  // no record begins so
    kHeader = 0x01,
    kFooter = 0x02,
    kSchema = 0x03,
    kChannel = 0x04,
    kMessage = 0x05,
    kChunk = 0x06,
    kMessageIndex = 0x07,
    kChunkIndex = 0x08,
    kStatistics = 0x0B,
    kMetadata = 0x0C,
    kMetadataIndex = 0x0D,
    kSummaryOffset = 0x0E,
    kDataEnd = 0x0F,
};

struct Schema {
    std::string name;      // "atrium::SiteMesh"
    std::string encoding;  // "omgidl", "jsonschema"
    std::string data;
};

struct Channel {
    std::uint16_t schema = 0;  // 0: none
    std::string topic;
    std::string message_encoding;  // "cdr", "json"
    StringMap metadata;
};

/// A message; its data is owned by someone else.
struct Message {
    std::uint16_t channel = 0;
    std::uint32_t sequence = 0;
    Timestamp log_time;      // when it was recorded; the order of a file
    Timestamp publish_time;  // when it was written
    std::span<const std::byte> data;
};

struct ChunkIndex {
    Timestamp first;  // log times of its messages
    Timestamp last;
    std::uint64_t offset = 0;                                // of the chunk record in the file
    std::uint64_t length = 0;                                // with its head
    std::map<std::uint16_t, std::uint64_t> message_indexes;  // by channel: offset in the file
    std::uint64_t message_index_length = 0;
    std::string compression;
    std::uint64_t compressed_size = 0;
    std::uint64_t size = 0;  // of its records, uncompressed
};

/// A metadata record and its place.
struct Metadata {
    std::string name;
    StringMap entries;
    std::uint64_t offset = 0;
    std::uint64_t length = 0;  // with its head
};

/// What a file holds, besides the messages themselves.
struct Contents {
    std::map<std::uint16_t, Schema> schemas;
    std::map<std::uint16_t, Channel> channels;
    std::vector<ChunkIndex> chunks;
    std::vector<Metadata> metadata;
    std::map<std::uint16_t, std::uint64_t> num_messages;  // by channel
};

// Writing. Each appends a whole record.
void put_header(Bytes& out);
void put_schema(Bytes& out, std::uint16_t id, const Schema& schema);
void put_channel(Bytes& out, std::uint16_t id, const Channel& channel);
void put_message(Bytes& out, const Message& message);
void put_metadata(Bytes& out, const Metadata& metadata);
/// Data end, summary, footer and magic: the end of a file whose data section ends at `offset`.
Bytes end_of_file(const Contents& contents, std::uint64_t offset);

/// The messages of one chunk, still without compression.
struct ChunkBuilder {
    Bytes records;
    Timestamp first;
    Timestamp last;
    std::map<std::uint16_t, std::vector<std::pair<Timestamp, std::uint64_t>>> index;
    std::uint64_t num_messages = 0;

    void add(const Message& message);
    void clear();
};
/// The index records that follow the chunk; fills `chunk.message_indexes` and its length. They
/// begin at `offset` in the file.
Bytes message_indexes(const ChunkBuilder& builder, std::uint64_t offset, ChunkIndex& chunk);

// Reading the content of a record, from bytes of anyone. kInvalidData if it is cut off.
struct NumberedSchema {
    std::uint16_t id = 0;
    Schema schema;
};
struct NumberedChannel {
    std::uint16_t id = 0;
    Channel channel;
};
Expected<NumberedSchema> read_schema(std::span<const std::byte> content);
Expected<NumberedChannel> read_channel(std::span<const std::byte> content);
Expected<Message> read_message(std::span<const std::byte> content);
Expected<ChunkIndex> read_chunk_index(std::span<const std::byte> content);
Expected<Metadata> read_metadata(std::span<const std::byte> content);

/// A chunk record: its head, and the compressed records.
struct ChunkRecord {
    ChunkIndex index;       // without offset, length and message indexes
    std::uint32_t crc = 0;  // of the records, uncompressed; 0: unknown
    std::span<const std::byte> records;
};
Expected<ChunkRecord> read_chunk(std::span<const std::byte> content);
/// Bytes in front of the records in a chunk's content.
void put_chunk_head(Bytes& out, const ChunkIndex& chunk, std::uint32_t crc);

/// One record after the other from memory.
struct Record {
    Opcode opcode{};
    std::span<const std::byte> content;
};
/// The next record; removes it from `bytes`. kInvalidData if it is cut off.
Expected<Record> next_record(std::span<const std::byte>& bytes);

}  // namespace atrium::mcap
