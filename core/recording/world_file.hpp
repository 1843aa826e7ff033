#pragma once

#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "core/bus/raw_samples.hpp"
#include "core/mcap/file.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::recording {

/// A sample of a recording. Its bytes belong to `chunk`.
struct PlayedSample {
    Timestamp time;  // when it was recorded
    const bus::RawTopic* topic = nullptr;
    bus::RawSample raw;
    std::shared_ptr<const mcap::Chunk> chunk;
};

/// A channel of the file, if it is one of a topic.
struct RecordedChannel {
    const bus::RawTopic* topic = nullptr;  // nullptr: not played
    bus::RawKind kind = bus::RawKind::kSample;
};

/// A program that a recording has, from its Presence.
struct RecordedProgram {
    bus::ProgramKind kind{};
    std::string name;
    std::string host;
    std::string version;
};

/// A recording of a world, opened for reading. Thread-safe after `open`.
class WorldFile {
public:
    static constexpr std::size_t kMaxKeptBytes = std::size_t{512} << 20U;

    /// As mcap::File::open; kInvalidData also if no channel is one of Atrium. Kept samples stay in
    /// memory: chunks of them beyond `max_kept_bytes` are left out, and `warnings` says so.
    static Expected<std::shared_ptr<const WorldFile>> open(
        const std::filesystem::path& file, std::size_t max_kept_bytes = kMaxKeptBytes);

    const mcap::File& file() const { return file_; }
    std::string world() const;    // its name; "atrium" if the file does not say
    std::string version() const;  // of the recorder; empty if the file does not say
    Timestamp begin() const { return begin_; }
    Timestamp end() const { return end_; }
    std::chrono::nanoseconds duration() const { return end_ - begin_; }
    /// Names of the sites that have a description, sorted.
    const std::vector<std::string>& sites() const { return sites_; }
    const std::vector<RecordedProgram>& programs() const { return programs_; }
    /// Samples by topic, without ends of instances.
    std::map<std::string, std::uint64_t> num_samples() const;
    /// Topics whose type is another one than this program's: their samples may be refused.
    const std::vector<std::string>& foreign_topics() const { return foreign_topics_; }

    /// What a user of it should know, each a line of the log: it is still written, it is cut off,
    /// it has more kept samples than are read, or topics of another version.
    std::vector<std::string> warnings() const;

    RecordedChannel channel(std::uint16_t id) const;

    /// Samples of topics that are kept (`is_kept`), by time, with their keys.
    struct Kept {
        PlayedSample sample;
        std::string key;
    };
    const std::vector<Kept>& kept() const { return kept_; }

private:
    explicit WorldFile(mcap::File file) : file_(std::move(file)) {}
    Expected<void> read_channels();
    void read_kept(std::size_t max_bytes);

    mcap::File file_;
    Timestamp begin_;
    Timestamp end_;
    std::map<std::uint16_t, RecordedChannel> channels_;
    std::vector<std::string> foreign_topics_;
    std::vector<Kept> kept_;
    Timestamp kept_until_;  // if not zero, those of later chunks were left out
    std::vector<std::string> sites_;
    std::vector<RecordedProgram> programs_;
};

}  // namespace atrium::recording
