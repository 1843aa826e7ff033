#include "core/mcap/file.hpp"

#include "core/mcap/scan.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace atrium::mcap {
namespace {

constexpr std::uint64_t kFooterBytes = kRecordHeadBytes + 20;
constexpr std::uint64_t kMaxSummaryBytes = std::uint64_t{256} << 20U;
constexpr std::uint64_t kMaxMetadataBytes = std::uint64_t{16} << 20U;  // all of a file's

bool is_inside(const ChunkIndex& chunk, std::uint64_t file_size) {
    return chunk.offset <= file_size && chunk.length <= file_size - chunk.offset &&
           chunk.compressed_size <= chunk.length;
}

}  // namespace

// False if there is no summary that can be trusted.
Expected<bool> File::read_summary() {
    struct stat status {};
    if (::fstat(descriptor_.get(), &status) != 0) return false;
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size < kMagic.size() * 2 + kFooterBytes) return false;
    const std::uint64_t footer_at = size - kMagic.size() - kFooterBytes;
    auto end = read_at(descriptor_.get(), footer_at, kFooterBytes + kMagic.size());
    if (!end) return false;
    if (std::memcmp(end->data() + kFooterBytes, kMagic.data(), kMagic.size()) != 0) return false;
    ByteReader footer(*end);
    if (footer.get<std::uint8_t>() != static_cast<std::uint8_t>(Opcode::kFooter)) return false;
    static_cast<void>(footer.get<std::uint64_t>());  // length
    const auto summary_at = footer.get<std::uint64_t>();
    static_cast<void>(footer.get<std::uint64_t>());  // of the summary offsets
    const auto crc = footer.get<std::uint32_t>();
    if (summary_at == 0 || summary_at > footer_at || footer_at - summary_at > kMaxSummaryBytes)
        return false;
    const auto summary = read_at(descriptor_.get(), summary_at, footer_at - summary_at);
    if (!summary) return false;
    const auto up_to_crc = std::span(*end).first(kRecordHeadBytes + 16);
    if (crc != 0 && crc != crc32(up_to_crc, crc32(*summary))) return false;
    bool has_statistics = false;
    std::uint64_t metadata_bytes = 0;
    std::span<const std::byte> rest(*summary);
    while (!rest.empty()) {
        const auto record = next_record(rest);
        if (!record) return false;
        if (record->opcode == Opcode::kSchema) {
            auto schema = read_schema(record->content);
            if (!schema) return false;
            contents_.schemas[schema->id] = std::move(schema->schema);
        } else if (record->opcode == Opcode::kChannel) {
            auto channel = read_channel(record->content);
            if (!channel) return false;
            contents_.channels[channel->id] = std::move(channel->channel);
        } else if (record->opcode == Opcode::kChunkIndex) {
            auto chunk = read_chunk_index(record->content);
            if (!chunk || !is_inside(*chunk, size)) return false;
            contents_.chunks.push_back(std::move(*chunk));
        } else if (record->opcode == Opcode::kStatistics) {
            ByteReader in(record->content);
            static_cast<void>(in.take(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8));
            ByteReader counts(in.take(in.get<std::uint32_t>()));
            has_statistics = in.ok();
            while (counts.ok() && !counts.rest().empty()) {
                const auto channel = counts.get<std::uint16_t>();
                contents_.num_messages[channel] = counts.get<std::uint64_t>();
            }
        } else if (record->opcode == Opcode::kMetadataIndex) {
            ByteReader in(record->content);
            const auto at = in.get<std::uint64_t>();
            const auto length = in.get<std::uint64_t>();
            if (!in.ok() || length > kMaxMetadataBytes - metadata_bytes) return false;
            metadata_bytes += length;
            const auto bytes = read_at(descriptor_.get(), at, length);
            if (!bytes) return false;
            std::span<const std::byte> one(*bytes);
            const auto inner = next_record(one);
            if (!inner || inner->opcode != Opcode::kMetadata) return false;
            auto metadata = read_metadata(inner->content);
            if (!metadata) return false;
            metadata->offset = at;
            metadata->length = length;
            contents_.metadata.push_back(std::move(*metadata));
        }
    }
    return has_statistics && !contents_.chunks.empty();
}

Expected<File> File::open(const std::filesystem::path& path) {
    File file;
    file.path_ = path;
    file.descriptor_ = Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.descriptor_.get() < 0) {
        return make_error(
            ErrorKind::kNotFound,
            fmt::format("{}: cannot read it: {}", path.string(), std::strerror(errno)));
    }
    struct stat status {};
    if (::fstat(file.descriptor_.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: it is no regular file", path.string()));
    }
    if (::flock(file.descriptor_.get(), LOCK_SH | LOCK_NB) != 0)
        file.is_being_written_ = errno == EWOULDBLOCK;
    else
        ::flock(file.descriptor_.get(), LOCK_UN);
    const auto has_summary = file.read_summary();
    if (!has_summary) return tl::unexpected(has_summary.error());
    if (!*has_summary) {
        file.contents_ = {};
        auto found = scan(file.descriptor_.get(), path);
        if (!found) return tl::unexpected(found.error());
        if (found->contents.chunks.empty()) {
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("{}: it has no whole chunk{}{}",
                                          path.string(),
                                          found->fault.empty() ? "" : ": ",
                                          found->fault));
        }
        file.contents_ = std::move(found->contents);
        file.num_damaged_chunks_ = found->num_damaged_chunks;
        file.fault_ = found->fault.empty() ? "its summary is missing or damaged" : found->fault;
    }
    return file;
}

Expected<Chunk> File::read(std::size_t number) const {
    const ChunkIndex& index = contents_.chunks[number];
    const auto fail = [&](const Error& why) {
        return make_error(why.kind,
                          fmt::format("{}: chunk {} of {}: {}",
                                      path_.string(),
                                      number + 1,
                                      contents_.chunks.size(),
                                      why.message));
    };
    auto read = read_chunk_at(descriptor_.get(), index.offset, index.length);
    if (!read) return fail(read.error());
    Chunk chunk;
    chunk.records = std::move(read->records);
    auto messages = messages_of(chunk.records);
    if (!messages) return fail(messages.error());
    chunk.messages = std::move(*messages);
    std::ranges::stable_sort(chunk.messages, {}, &Message::log_time);
    return chunk;
}

}  // namespace atrium::mcap
