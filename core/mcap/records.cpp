#include "core/mcap/records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace atrium::mcap {
namespace {

// Writes opcode and length, and the length again once the content is there.
class RecordScope {
public:
    RecordScope(Bytes& out, Opcode opcode) : out_(out) {
        put(out_, static_cast<std::uint8_t>(opcode));
        length_at_ = out_.size();
        put(out_, std::uint64_t{0});
    }
    RecordScope(const RecordScope&) = delete;
    RecordScope& operator=(const RecordScope&) = delete;
    ~RecordScope() {
        const std::uint64_t length = out_.size() - length_at_ - sizeof(std::uint64_t);
        std::memcpy(out_.data() + length_at_, &length, sizeof(length));
    }

private:
    Bytes& out_;
    std::size_t length_at_ = 0;
};

// MCAP's times are unsigned.
void put_time(Bytes& out, Timestamp time) {
    put(out, static_cast<std::uint64_t>(std::max<std::int64_t>(time.ns, 0)));
}

Timestamp get_time(ByteReader& in) {
    constexpr std::uint64_t kLast = std::numeric_limits<std::int64_t>::max() / 2;
    return {static_cast<std::int64_t>(std::min(in.get<std::uint64_t>(), kLast))};
}

template <typename T>
Expected<T> whole(const ByteReader& in, T value, const char* what) {
    if (!in.ok())
        return make_error(ErrorKind::kInvalidData, fmt::format("a {} record is too short", what));
    return value;
}

}  // namespace

void put_header(Bytes& out) {
    const RecordScope scope(out, Opcode::kHeader);
    put_string(out, "");  // no profile
    put_string(out, "atrium");
}

void put_schema(Bytes& out, std::uint16_t id, const Schema& schema) {
    const RecordScope scope(out, Opcode::kSchema);
    put(out, id);
    put_string(out, schema.name);
    put_string(out, schema.encoding);
    put_string(out, schema.data);
}

void put_channel(Bytes& out, std::uint16_t id, const Channel& channel) {
    const RecordScope scope(out, Opcode::kChannel);
    put(out, id);
    put(out, channel.schema);
    put_string(out, channel.topic);
    put_string(out, channel.message_encoding);
    put_map(out, channel.metadata);
}

void put_message(Bytes& out, const Message& message) {
    const RecordScope scope(out, Opcode::kMessage);
    put(out, message.channel);
    put(out, message.sequence);
    put_time(out, message.log_time);
    put_time(out, message.publish_time);
    put_bytes(out, message.data);
}

void put_metadata(Bytes& out, const Metadata& metadata) {
    const RecordScope scope(out, Opcode::kMetadata);
    put_string(out, metadata.name);
    put_map(out, metadata.entries);
}

void put_chunk_head(Bytes& out, const ChunkIndex& chunk, std::uint32_t crc) {
    put(out, static_cast<std::uint8_t>(Opcode::kChunk));
    const std::uint64_t head = 8 + 8 + 8 + 4 + 4 + chunk.compression.size() + 8;
    put(out, head + chunk.compressed_size);
    put_time(out, chunk.first);
    put_time(out, chunk.last);
    put(out, chunk.size);
    put(out, crc);
    put_string(out, chunk.compression);
    put(out, chunk.compressed_size);
}

void ChunkBuilder::add(const Message& message) {
    index[message.channel].emplace_back(message.log_time, records.size());
    first = num_messages == 0 ? message.log_time : std::min(first, message.log_time);
    last = num_messages == 0 ? message.log_time : std::max(last, message.log_time);
    ++num_messages;
    put_message(records, message);
}

void ChunkBuilder::clear() {
    records.clear();
    index.clear();
    num_messages = 0;
}

Bytes message_indexes(const ChunkBuilder& builder, std::uint64_t offset, ChunkIndex& chunk) {
    Bytes out;
    chunk.message_indexes.clear();
    for (const auto& [channel, places] : builder.index) {
        chunk.message_indexes[channel] = offset + out.size();
        const RecordScope scope(out, Opcode::kMessageIndex);
        put(out, channel);
        put(out, static_cast<std::uint32_t>(places.size() * 16));
        for (const auto& [time, place] : places) {
            put_time(out, time);
            put(out, place);
        }
    }
    chunk.message_index_length = out.size();
    return out;
}

namespace {

void put_chunk_index(Bytes& out, const ChunkIndex& chunk) {
    const RecordScope scope(out, Opcode::kChunkIndex);
    put_time(out, chunk.first);
    put_time(out, chunk.last);
    put(out, chunk.offset);
    put(out, chunk.length);
    put(out, static_cast<std::uint32_t>(chunk.message_indexes.size() * 10));
    for (const auto& [channel, offset] : chunk.message_indexes) {
        put(out, channel);
        put(out, offset);
    }
    put(out, chunk.message_index_length);
    put_string(out, chunk.compression);
    put(out, chunk.compressed_size);
    put(out, chunk.size);
}

void put_statistics(Bytes& out, const Contents& contents) {
    std::uint64_t num_messages = 0;
    for (const auto& [channel, num] : contents.num_messages) num_messages += num;
    Timestamp first;
    Timestamp last;
    for (const ChunkIndex& chunk : contents.chunks) {
        const bool is_first = &chunk == &contents.chunks.front();
        first = is_first ? chunk.first : std::min(first, chunk.first);
        last = is_first ? chunk.last : std::max(last, chunk.last);
    }
    const RecordScope scope(out, Opcode::kStatistics);
    put(out, num_messages);
    put(out, static_cast<std::uint16_t>(contents.schemas.size()));
    put(out, static_cast<std::uint32_t>(contents.channels.size()));
    put(out, std::uint32_t{0});  // attachments
    put(out, static_cast<std::uint32_t>(contents.metadata.size()));
    put(out, static_cast<std::uint32_t>(contents.chunks.size()));
    put_time(out, first);
    put_time(out, last);
    put(out, static_cast<std::uint32_t>(contents.num_messages.size() * 10));
    for (const auto& [channel, num] : contents.num_messages) {
        put(out, channel);
        put(out, num);
    }
}

void put_metadata_index(Bytes& out, const Metadata& metadata) {
    const RecordScope scope(out, Opcode::kMetadataIndex);
    put(out, metadata.offset);
    put(out, metadata.length);
    put_string(out, metadata.name);
}

}  // namespace

Bytes end_of_file(const Contents& contents, std::uint64_t offset) {
    Bytes out;
    {
        const RecordScope scope(out, Opcode::kDataEnd);
        put(out, std::uint32_t{0});  // no CRC over all data: each chunk has its own
    }
    const std::size_t summary_at = out.size();
    struct Group {
        Opcode opcode{};
        std::size_t begin = 0;
        std::size_t end = 0;
    };
    std::vector<Group> groups;
    const auto group = [&](Opcode opcode, const auto& write) {
        const std::size_t begin = out.size();
        write();
        if (out.size() > begin) groups.push_back({opcode, begin, out.size()});
    };
    group(Opcode::kSchema, [&] {
        for (const auto& [id, schema] : contents.schemas) put_schema(out, id, schema);
    });
    group(Opcode::kChannel, [&] {
        for (const auto& [id, channel] : contents.channels) put_channel(out, id, channel);
    });
    group(Opcode::kStatistics, [&] { put_statistics(out, contents); });
    group(Opcode::kChunkIndex, [&] {
        for (const ChunkIndex& chunk : contents.chunks) put_chunk_index(out, chunk);
    });
    group(Opcode::kMetadataIndex, [&] {
        for (const Metadata& metadata : contents.metadata) put_metadata_index(out, metadata);
    });
    const std::size_t offsets_at = out.size();
    for (const Group& one : groups) {
        const RecordScope scope(out, Opcode::kSummaryOffset);
        put(out, static_cast<std::uint8_t>(one.opcode));
        put(out, offset + one.begin);
        put(out, std::uint64_t{one.end - one.begin});
    }
    // The CRC covers the summary and the footer up to the CRC itself.
    put(out, static_cast<std::uint8_t>(Opcode::kFooter));
    put(out, std::uint64_t{8 + 8 + 4});
    put(out, offset + summary_at);
    put(out, offset + offsets_at);
    put(out, crc32(std::span(out).subspan(summary_at)));
    put_bytes(out, std::as_bytes(std::span(kMagic)));
    return out;
}

Expected<NumberedSchema> read_schema(std::span<const std::byte> content) {
    ByteReader in(content);
    NumberedSchema out;
    out.id = in.get<std::uint16_t>();
    out.schema.name = in.string();
    out.schema.encoding = in.string();
    out.schema.data = in.string();
    return whole(in, std::move(out), "schema");
}

Expected<NumberedChannel> read_channel(std::span<const std::byte> content) {
    ByteReader in(content);
    NumberedChannel out;
    out.id = in.get<std::uint16_t>();
    out.channel.schema = in.get<std::uint16_t>();
    out.channel.topic = in.string();
    out.channel.message_encoding = in.string();
    out.channel.metadata = in.map();
    return whole(in, std::move(out), "channel");
}

Expected<Message> read_message(std::span<const std::byte> content) {
    ByteReader in(content);
    Message out;
    out.channel = in.get<std::uint16_t>();
    out.sequence = in.get<std::uint32_t>();
    out.log_time = get_time(in);
    out.publish_time = get_time(in);
    out.data = in.rest();
    return whole(in, out, "message");
}

Expected<ChunkIndex> read_chunk_index(std::span<const std::byte> content) {
    ByteReader in(content);
    ChunkIndex out;
    out.first = get_time(in);
    out.last = get_time(in);
    out.offset = in.get<std::uint64_t>();
    out.length = in.get<std::uint64_t>();
    ByteReader places(in.take(in.get<std::uint32_t>()));
    while (places.ok() && !places.rest().empty()) {
        const auto channel = places.get<std::uint16_t>();
        out.message_indexes[channel] = places.get<std::uint64_t>();
    }
    out.message_index_length = in.get<std::uint64_t>();
    out.compression = in.string();
    out.compressed_size = in.get<std::uint64_t>();
    out.size = in.get<std::uint64_t>();
    if (!places.ok()) return make_error(ErrorKind::kInvalidData, "a chunk index record is cut off");
    return whole(in, std::move(out), "chunk index");
}

Expected<Metadata> read_metadata(std::span<const std::byte> content) {
    ByteReader in(content);
    Metadata out;
    out.name = in.string();
    out.entries = in.map();
    return whole(in, std::move(out), "metadata");
}

Expected<ChunkRecord> read_chunk(std::span<const std::byte> content) {
    ByteReader in(content);
    ChunkRecord out;
    out.index.first = get_time(in);
    out.index.last = get_time(in);
    out.index.size = in.get<std::uint64_t>();
    out.crc = in.get<std::uint32_t>();
    out.index.compression = in.string();
    out.index.compressed_size = in.get<std::uint64_t>();
    out.records = in.take(out.index.compressed_size);
    return whole(in, std::move(out), "chunk");
}

Expected<Record> next_record(std::span<const std::byte>& bytes) {
    ByteReader in(bytes);
    Record record;
    record.opcode = static_cast<Opcode>(in.get<std::uint8_t>());
    record.content = in.take(in.get<std::uint64_t>());
    bytes = in.rest();
    return whole(in, record, "cut off");
}

}  // namespace atrium::mcap
