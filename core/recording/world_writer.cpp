#include "core/recording/world_writer.hpp"

#include "core/recording/topic_roles.hpp"

#include <fmt/format.h>

#include <utility>

namespace atrium::recording {
namespace {

constexpr std::size_t kKeptLane = 0;
constexpr std::size_t kOtherLane = 1;
constexpr std::size_t kNumLanes = 2;
constexpr std::size_t kChunkBytes = std::size_t{4} << 20U;
// Of what is kept for the next file; hostile programs could make more.
constexpr std::size_t kMaxForNext = 100'000;
constexpr std::size_t kMaxBytesForNext = std::size_t{64} << 20U;

constexpr std::string_view kNoteSchema =
    R"({"type":"object","properties":{"num_samples":{"type":"integer"},)"
    R"("num_dropped":{"type":"integer"},"dropped":{"type":"object"},)"
    R"("num_rejected":{"type":"integer"},"waiting_bytes":{"type":"integer"}}})";

std::string channel_name(const bus::RawTopic& topic, bus::RawKind kind) {
    const std::string name(topic.name());
    if (kind == bus::RawKind::kDisposed) return name + "/disposed";
    return kind == bus::RawKind::kLost ? name + "/lost" : name;
}

}  // namespace

std::filesystem::path part_name(const std::filesystem::path& file, std::size_t part) {
    if (part <= 1) return file;
    std::filesystem::path name = file.stem();
    name += fmt::format("-{}", part);
    name += file.extension();
    return file.parent_path() / name;
}

Expected<WorldWriter> WorldWriter::create(WriterOptions options) {
    WorldWriter writer(std::move(options));
    if (auto begun = writer.begin_file(Timestamp::now()); !begun)
        return tl::unexpected(begun.error());
    return writer;
}

Expected<void> WorldWriter::begin_file(Timestamp time) {
    std::filesystem::path file = part_name(options_.file, ++last_number_);
    // Nobody is there to choose another name when a recording of hours goes on in its next file.
    std::error_code failure;
    while (!files_.empty() && std::filesystem::exists(file, failure))
        file = part_name(options_.file, ++last_number_);
    auto out = mcap::Writer::create(file, kNumLanes);
    if (!out) return tl::unexpected(out.error());
    out_.emplace(std::move(*out));
    files_.push_back(file);
    schemas_.clear();
    channels_.clear();
    notes_.reset();
    sequences_.clear();
    unflushed_since_.assign(kNumLanes, {});
    file_begin_ = time;
    mcap::Metadata metadata;
    metadata.name = "atrium";
    metadata.entries = {{"world", options_.world},
                        {"host", options_.host},
                        {"version", options_.version},
                        {"part", std::to_string(files_.size())}};
    return out_->add(std::move(metadata));
}

Expected<std::uint16_t> WorldWriter::channel_of(const bus::RawTopic& topic, bus::RawKind kind) {
    if (const auto found = channels_.find({&topic, kind}); found != channels_.end())
        return found->second;
    auto schema = schemas_.find(topic.type_name());
    if (schema == schemas_.end()) {
        const auto added = out_->add(
            mcap::Schema{std::string(topic.type_name()), "omgidl", std::string(bus::kIdl)});
        if (!added) return added;
        schema = schemas_.emplace(topic.type_name(), *added).first;
    }
    const auto channel =
        out_->add(mcap::Channel{schema->second, channel_name(topic, kind), "cdr", {}});
    if (channel) channels_[{&topic, kind}] = *channel;
    return channel;
}

Expected<void> WorldWriter::put(const Recorded& sample, Timestamp time) {
    const auto channel = channel_of(*sample.topic, sample.kind);
    if (!channel) {
        ++not_begun_[std::string(sample.topic->name())];
        return tl::unexpected(channel.error());
    }
    const std::size_t lane = is_kept(*sample.topic) ? kKeptLane : kOtherLane;
    return put_message(lane, {*channel, sequences_[*channel]++, time, sample.written, sample.cdr});
}

Expected<void> WorldWriter::put_message(std::size_t lane, const mcap::Message& message) {
    out_->write(lane, message);
    auto& since = unflushed_since_[lane];
    if (!since) since = std::chrono::steady_clock::now();
    if (out_->lane_bytes(lane) < kChunkBytes) return {};
    since.reset();
    return out_->flush(lane);
}

Expected<void> WorldWriter::write(const Recorded& sample) {
    if (auto cut = cut_if_due(sample.time); !cut) {
        ++not_begun_[std::string(sample.topic->name())];
        return cut;
    }
    if (cuts() && is_kept(*sample.topic)) {
        auto key = sample.topic->key_of({sample.kind, sample.written, sample.cdr});
        if (!key) return {};  // it cannot have come from a reader
        keep(sample, std::move(*key));
    }
    return put(sample, sample.time);
}

void WorldWriter::keep(const Recorded& sample, std::string key) {
    const std::pair name{sample.topic, std::move(key)};
    if (const auto old = kept_.find(name); old != kept_.end()) {
        kept_bytes_ -= old->second.cdr.size();
        kept_.erase(old);
    }
    if (sample.kind != bus::RawKind::kSample || kept_.size() >= kMaxForNext ||
        kept_bytes_ + sample.cdr.size() > kMaxBytesForNext)
        return;
    kept_bytes_ += sample.cdr.size();
    kept_.emplace(name, sample);
}

Expected<void> WorldWriter::cut_if_due(Timestamp time) {
    const bool is_full = options_.cut_bytes > 0 && out_->num_bytes() >= options_.cut_bytes;
    const bool is_over =
        options_.cut_after.count() > 0 && file_begin_ && time - *file_begin_ >= options_.cut_after;
    if (!is_full && !is_over) return {};
    if (auto done = finish(); !done) return done;
    const std::uint64_t num_bytes = out_->num_bytes();
    if (auto begun = begin_file(time); !begun) return begun;
    bytes_of_former_ += num_bytes;
    for (const auto& [key, sample] : kept_) {
        if (auto done = put(sample, time); !done) return done;
    }
    return {};
}

Expected<void> WorldWriter::note(Timestamp time, const std::string& json) {
    if (!notes_) {
        const auto schema =
            out_->add(mcap::Schema{"atrium.Recorder", "jsonschema", std::string(kNoteSchema)});
        if (!schema) return tl::unexpected(schema.error());
        const auto channel = out_->add(mcap::Channel{*schema, "recorder", "json", {}});
        if (!channel) return tl::unexpected(channel.error());
        notes_ = *channel;
    }
    return put_message(
        kOtherLane, {*notes_, sequences_[*notes_]++, time, time, std::as_bytes(std::span(json))});
}

Expected<void> WorldWriter::flush_due(std::chrono::steady_clock::time_point now) {
    for (std::size_t lane = 0; lane < unflushed_since_.size(); ++lane) {
        auto& since = unflushed_since_[lane];
        if (!since || now - *since < kFlushAfter) continue;
        since.reset();
        if (auto done = out_->flush(lane); !done) return done;
    }
    return {};
}

Expected<void> WorldWriter::finish() { return out_->finish(); }

// Only the last file can have lost some: the first error ends a recording.
std::map<std::string, std::uint64_t> WorldWriter::lost() const {
    std::map<std::string, std::uint64_t> by_topic = not_begun_;
    for (const auto& [channel, num] : out_->lost()) {
        if (channel == notes_) continue;
        const std::string& name = out_->contents().channels.at(channel).topic;
        by_topic[name.substr(0, name.find('/'))] += num;
    }
    return by_topic;
}

std::uint64_t WorldWriter::num_bytes() const {
    return bytes_of_former_ + (out_ ? out_->num_bytes() : 0);
}

}  // namespace atrium::recording
