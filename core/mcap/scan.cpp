#include "core/mcap/scan.hpp"

#include "core/mcap/compression.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace atrium::mcap {
namespace {

constexpr std::uint64_t kMaxSmallRecordBytes = std::uint64_t{16} << 20U;
constexpr std::size_t kMaxSchemasAndChannels = 10'000;
constexpr std::size_t kMaxMetadata = 1'000;

struct RecordHead {
    Opcode opcode{};
    std::uint64_t length = 0;  // of the content
};

Expected<RecordHead> head_at(int descriptor, std::uint64_t offset) {
    const auto bytes = read_at(descriptor, offset, kRecordHeadBytes);
    if (!bytes) return tl::unexpected(bytes.error());
    ByteReader in(*bytes);
    RecordHead head;
    head.opcode = static_cast<Opcode>(in.get<std::uint8_t>());
    head.length = in.get<std::uint64_t>();
    return head;
}

// The schemas and channels that are in a chunk's records, as other programs write them, and the
// number of its messages.
Expected<Contents> look_into(std::span<const std::byte> records) {
    Contents contents;
    while (!records.empty()) {
        const auto record = next_record(records);
        if (!record) return tl::unexpected(record.error());
        if (record->opcode == Opcode::kSchema) {
            auto schema = read_schema(record->content);
            if (!schema) return tl::unexpected(schema.error());
            contents.schemas[schema->id] = std::move(schema->schema);
        } else if (record->opcode == Opcode::kChannel) {
            auto channel = read_channel(record->content);
            if (!channel) return tl::unexpected(channel.error());
            contents.channels[channel->id] = std::move(channel->channel);
        } else if (record->opcode == Opcode::kMessage) {
            const auto message = read_message(record->content);
            if (!message) return tl::unexpected(message.error());
            ++contents.num_messages[message->channel];
        }
        if (contents.schemas.size() + contents.channels.size() > kMaxSchemasAndChannels)
            return make_error(ErrorKind::kInvalidData, "too many schemas and channels");
    }
    return contents;
}

class Scanner {
public:
    Scanner(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}

    Scan run() {
        scan_.end = kMagic.size();
        for (;;) {
            const auto done = next();
            if (!done) {
                scan_.fault = done.error().message;
                scan_.is_read = done.error().kind == ErrorKind::kInvalidData;
                break;
            }
            if (*done) break;
        }
        return std::move(scan_);
    }

private:
    // True at the end of the data.
    Expected<bool> next() {
        const std::uint64_t at = at_;
        if (at == size_) return make_error(ErrorKind::kInvalidData, "it has no end");
        if (size_ - at < kRecordHeadBytes)
            return make_error(ErrorKind::kInvalidData, "its last record is cut off");
        const auto head = head_at(descriptor_, at);
        if (!head) return tl::unexpected(head.error());
        if (head->length > size_ - at - kRecordHeadBytes)
            return make_error(ErrorKind::kInvalidData, "its last record is cut off");
        const std::uint64_t end = at + kRecordHeadBytes + head->length;
        switch (head->opcode) {
            case Opcode::kDataEnd:
            case Opcode::kFooter:
                scan_.is_complete = true;
                return true;
            case Opcode::kChunk:
                finish_chunk(at);
                if (const auto done = add_chunk(at, *head); done) {
                    scan_.end = end;
                    is_damaged_ = false;
                } else if (done.error().kind != ErrorKind::kInvalidData) {
                    return tl::unexpected(done.error());
                } else {
                    ++scan_.num_damaged_chunks;  // those behind it may be whole
                    is_damaged_ = true;
                }
                break;
            case Opcode::kMessageIndex:
                if (auto done = add_index(at, *head); !done) return tl::unexpected(done.error());
                break;
            case Opcode::kMessage:
                scan_.has_loose_messages = true;
                return make_error(ErrorKind::kInvalidData,
                                  "it has messages outside of chunks; rewrite it with chunks "
                                  "(mcap recover)");
            case Opcode::kSchema:
            case Opcode::kChannel:
            case Opcode::kMetadata:
                if (auto done = add_small(at, *head); !done) return tl::unexpected(done.error());
                scan_.end = end;
                break;
            case Opcode::kNone:
                return make_error(ErrorKind::kInvalidData,
                                  fmt::format("it is damaged at byte {}", at));
            default:
                break;  // the header, and what this program does not know
        }
        at_ = end;
        return false;
    }

    Expected<void> add_chunk(std::uint64_t at, const RecordHead& head) {
        auto chunk = read_chunk_at(descriptor_, at, kRecordHeadBytes + head.length);
        if (!chunk) return tl::unexpected(chunk.error());
        if (auto done = add_records(chunk->records); !done) return done;
        scan_.contents.chunks.push_back(std::move(chunk->index));
        return {};
    }

    // All or nothing.
    Expected<void> add_records(std::span<const std::byte> records) {
        auto found = look_into(records);
        if (!found) return tl::unexpected(found.error());
        Contents& all = scan_.contents;
        if (all.schemas.size() + all.channels.size() + found->schemas.size() +
                found->channels.size() >
            kMaxSchemasAndChannels)
            return make_error(ErrorKind::kInvalidData, "too many schemas and channels");
        for (auto& [id, schema] : found->schemas) all.schemas[id] = std::move(schema);
        for (auto& [id, channel] : found->channels) all.channels[id] = std::move(channel);
        for (const auto& [id, num] : found->num_messages) all.num_messages[id] += num;
        return {};
    }

    // The indexes of a chunk follow it. They count once all are there.
    Expected<void> add_index(std::uint64_t at, const RecordHead& head) {
        if (is_damaged_) return {};
        if (head.length > kMaxSmallRecordBytes || scan_.contents.chunks.empty())
            return make_error(ErrorKind::kInvalidData, "a message index is out of place");
        const auto content = read_at(descriptor_, at + kRecordHeadBytes, head.length);
        if (!content) return tl::unexpected(content.error());
        ByteReader in(*content);
        const auto channel = in.get<std::uint16_t>();
        if (!in.ok()) return make_error(ErrorKind::kInvalidData, "a message index is too short");
        open_indexes_[channel] = at;
        open_length_ += kRecordHeadBytes + head.length;
        return {};
    }

    // The records up to `at` are those of the last chunk.
    void finish_chunk(std::uint64_t at) {
        if (!scan_.contents.chunks.empty() && !open_indexes_.empty()) {
            scan_.end = at;
            ChunkIndex& chunk = scan_.contents.chunks.back();
            chunk.message_indexes = std::move(open_indexes_);
            chunk.message_index_length = open_length_;
        }
        open_indexes_.clear();
        open_length_ = 0;
    }

    Expected<void> add_small(std::uint64_t at, const RecordHead& head) {
        finish_chunk(at);
        if (head.length > kMaxSmallRecordBytes)
            return make_error(ErrorKind::kInvalidData, "a record is too long");
        const auto bytes = read_at(descriptor_, at, kRecordHeadBytes + head.length);
        if (!bytes) return tl::unexpected(bytes.error());
        if (head.opcode != Opcode::kMetadata) return add_records(*bytes);
        if (scan_.contents.metadata.size() == kMaxMetadata)
            return make_error(ErrorKind::kInvalidData, "too much metadata");
        auto metadata = read_metadata(std::span(*bytes).subspan(kRecordHeadBytes));
        if (!metadata) return tl::unexpected(metadata.error());
        metadata->offset = at;
        metadata->length = bytes->size();
        scan_.contents.metadata.push_back(std::move(*metadata));
        return {};
    }

    int descriptor_;
    std::uint64_t size_;
    std::uint64_t at_ = kMagic.size();
    Scan scan_;
    std::map<std::uint16_t, std::uint64_t> open_indexes_;
    std::uint64_t open_length_ = 0;
    bool is_damaged_ = false;  // the last chunk
};

}  // namespace

Expected<Bytes> read_at(int descriptor, std::uint64_t offset, std::uint64_t size) {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0)
        return make_error(ErrorKind::kUnavailable, std::strerror(errno));
    const auto file_size = static_cast<std::uint64_t>(status.st_size);
    if (offset > file_size || size > file_size - offset)
        return make_error(ErrorKind::kInvalidData, "it is cut off");
    Bytes bytes(static_cast<std::size_t>(size));
    std::size_t num_read = 0;
    while (num_read < bytes.size()) {
        const ssize_t n = ::pread(descriptor,
                                  bytes.data() + num_read,
                                  bytes.size() - num_read,
                                  static_cast<off_t>(offset + num_read));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return make_error(ErrorKind::kUnavailable, std::strerror(errno));
        if (n == 0) return make_error(ErrorKind::kInvalidData, "it is cut off");
        num_read += static_cast<std::size_t>(n);
    }
    return bytes;
}

Expected<Scan> scan(int descriptor, const std::filesystem::path& file) {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("{}: {}", file.string(), std::strerror(errno)));
    }
    const auto magic = read_at(descriptor, 0, kMagic.size());
    if (!magic || std::memcmp(magic->data(), kMagic.data(), kMagic.size()) != 0) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: it is no MCAP file", file.string()));
    }
    return Scanner(descriptor, static_cast<std::uint64_t>(status.st_size)).run();
}

Expected<ReadChunk> read_chunk_at(int descriptor, std::uint64_t offset, std::uint64_t length) {
    if (length < kRecordHeadBytes)
        return make_error(ErrorKind::kInvalidData, "its index is damaged");
    if (length > kMaxChunkRecordBytes) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("a chunk of {} bytes; at most {} are read", length, kMaxChunkRecordBytes));
    }
    const auto bytes = read_at(descriptor, offset, length);
    if (!bytes) return tl::unexpected(bytes.error());
    std::span<const std::byte> rest(*bytes);
    const auto record = next_record(rest);
    if (!record) return tl::unexpected(record.error());
    if (record->opcode != Opcode::kChunk)
        return make_error(ErrorKind::kInvalidData, "its index names a place that is no chunk");
    auto content = read_chunk(record->content);
    if (!content) return tl::unexpected(content.error());
    auto records = decompress(content->index.compression, content->records, content->index.size);
    if (!records) return tl::unexpected(records.error());
    if (content->crc != 0 && content->crc != crc32(*records))
        return make_error(ErrorKind::kInvalidData, "a chunk is damaged (CRC)");
    content->index.offset = offset;
    content->index.length = length;
    return ReadChunk{std::move(content->index), std::move(*records)};
}

Expected<std::vector<Message>> messages_of(std::span<const std::byte> records) {
    std::vector<Message> messages;
    while (!records.empty()) {
        const auto record = next_record(records);
        if (!record) return tl::unexpected(record.error());
        if (record->opcode != Opcode::kMessage) continue;
        const auto message = read_message(record->content);
        if (!message) return tl::unexpected(message.error());
        messages.push_back(*message);
    }
    return messages;
}

}  // namespace atrium::mcap
