#include "core/mcap/writer.hpp"

#include "core/base/write_check.hpp"
#include "core/mcap/file.hpp"
#include "core/mcap/scan.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace atrium::mcap {

Writer::Writer(std::filesystem::path file, Descriptor descriptor, std::size_t num_lanes)
    : file_(std::move(file)), descriptor_(std::move(descriptor)), lanes_(num_lanes) {}

Expected<Writer> Writer::create(const std::filesystem::path& file, std::size_t num_lanes) {
    Descriptor descriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
    if (descriptor.get() < 0) {
        if (errno == EEXIST) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("{}: the file exists; remove it, or give another name", file.string()));
        }
        return tl::unexpected(cannot_write(file, "create it", errno));
    }
    // A new file: nobody else has it, but a reader that looks whether it is locked, for a moment.
    while (::flock(descriptor.get(), LOCK_EX) != 0 && errno == EINTR) {
    }
    Writer writer(file, std::move(descriptor), num_lanes);
    Bytes head;
    put_bytes(head, std::as_bytes(std::span(kMagic)));
    put_header(head);
    if (auto done = writer.append(head); !done) return tl::unexpected(done.error());
    return writer;
}

// All or nothing: a part that was written is removed again.
Expected<void> Writer::append(std::span<const std::byte> bytes) {
    std::size_t num_written = 0;
    while (num_written < bytes.size()) {
        const ssize_t n = ::pwrite(descriptor_.get(),
                                   bytes.data() + num_written,
                                   bytes.size() - num_written,
                                   static_cast<off_t>(end_ + num_written));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
            const int reason = n < 0 ? errno : ENOSPC;
            if (::ftruncate(descriptor_.get(), static_cast<off_t>(end_)) != 0) {
                // The file then ends with a part of a record, which `File::open` leaves out.
            }
            return tl::unexpected(cannot_write(file_, "write it", reason));
        }
        num_written += static_cast<std::size_t>(n);
    }
    end_ += bytes.size();
    return {};
}

Expected<std::uint16_t> Writer::add(const Schema& schema) {
    const auto id = static_cast<std::uint16_t>(contents_.schemas.size() + 1);
    Bytes record;
    put_schema(record, id, schema);
    if (auto done = append(record); !done) return tl::unexpected(done.error());
    contents_.schemas[id] = schema;
    return id;
}

Expected<std::uint16_t> Writer::add(const Channel& channel) {
    const auto id = static_cast<std::uint16_t>(contents_.channels.size());
    Bytes record;
    put_channel(record, id, channel);
    if (auto done = append(record); !done) return tl::unexpected(done.error());
    contents_.channels[id] = channel;
    return id;
}

Expected<void> Writer::add(Metadata metadata) {
    Bytes record;
    put_metadata(record, metadata);
    metadata.offset = end_;
    metadata.length = record.size();
    if (auto done = append(record); !done) return done;
    contents_.metadata.push_back(std::move(metadata));
    return {};
}

Expected<void> Writer::flush(std::size_t lane) {
    ChunkBuilder& builder = lanes_[lane];
    if (builder.num_messages == 0) return {};
    ChunkIndex chunk;
    chunk.first = builder.first;
    chunk.last = builder.last;
    chunk.offset = end_;
    chunk.size = builder.records.size();
    chunk.compression = "zstd";
    // The head is as long whatever it says: the records are compressed behind it.
    buffer_.clear();
    put_chunk_head(buffer_, chunk, 0);
    const std::size_t head = buffer_.size();
    const auto written = [&]() -> Expected<void> {
        if (auto done = compressor_.compress(builder.records, buffer_); !done) return done;
        chunk.compressed_size = buffer_.size() - head;
        chunk.length = buffer_.size();
        Bytes true_head;
        put_chunk_head(true_head, chunk, crc32(builder.records));
        std::copy(true_head.begin(), true_head.end(), buffer_.begin());
        const Bytes indexes = message_indexes(builder, end_ + buffer_.size(), chunk);
        put_bytes(buffer_, indexes);
        return append(buffer_);
    }();
    auto& counts = written ? contents_.num_messages : lost_;
    for (const auto& [channel, places] : builder.index) counts[channel] += places.size();
    if (written) contents_.chunks.push_back(std::move(chunk));
    builder.clear();
    return written;
}

Expected<void> Writer::finish() {
    if (std::exchange(is_finished_, true)) return {};
    Expected<void> flushed;
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
        if (auto done = flush(lane); !done) flushed = done;
    }
    // Also after a chunk that found no room: a summary is small.
    auto done = append(end_of_file(contents_, end_));
    return flushed ? done : flushed;
}

Expected<void> repair(const std::filesystem::path& file) {
    Descriptor descriptor(::open(file.c_str(), O_RDWR | O_CLOEXEC));
    if (descriptor.get() < 0) return tl::unexpected(cannot_write(file, "repair it", errno));
    if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("{}: it is still being written", file.string()));
    }
    auto scanned = scan(descriptor.get(), file);
    if (!scanned) return tl::unexpected(scanned.error());
    // Nothing to keep, or more than would be kept.
    if (!scanned->is_read || scanned->has_loose_messages || scanned->contents.chunks.empty()) {
        const bool is_empty = scanned->is_read && !scanned->has_loose_messages;
        return make_error(
            scanned->is_read ? ErrorKind::kInvalidData : ErrorKind::kUnavailable,
            fmt::format(
                "{}: {}", file.string(), is_empty ? "it has no whole chunk" : scanned->fault));
    }
    Writer writer(file, std::move(descriptor), 0);
    // The indexes of the last chunk may be cut off: they are written anew.
    writer.end_ = scanned->end;
    Contents& contents = writer.contents_;
    contents = std::move(scanned->contents);
    if (::ftruncate(writer.descriptor_.get(), static_cast<off_t>(writer.end_)) != 0)
        return tl::unexpected(cannot_write(file, "repair it", errno));
    if (!contents.chunks.empty() && contents.chunks.back().message_indexes.empty()) {
        ChunkIndex& last = contents.chunks.back();
        auto chunk = read_chunk_at(writer.descriptor_.get(), last.offset, last.length);
        if (!chunk) return tl::unexpected(chunk.error());
        // Their places among the records, where other programs have schemas and channels too.
        ChunkBuilder builder;
        for (std::span<const std::byte> rest(chunk->records); !rest.empty();) {
            const std::uint64_t at = chunk->records.size() - rest.size();
            const auto record = next_record(rest);
            if (!record) return tl::unexpected(record.error());
            if (record->opcode != Opcode::kMessage) continue;
            const auto message = read_message(record->content);
            if (!message) return tl::unexpected(message.error());
            builder.index[message->channel].emplace_back(message->log_time, at);
        }
        if (auto done = writer.append(message_indexes(builder, writer.end_, last)); !done)
            return done;
    }
    return writer.append(end_of_file(contents, writer.end_));
}

}  // namespace atrium::mcap
