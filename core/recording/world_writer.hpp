#pragma once

#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "core/bus/raw_samples.hpp"
#include "core/mcap/writer.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::recording {

/// A sample that is to be recorded.
struct Recorded {
    const bus::RawTopic* topic = nullptr;
    bus::RawKind kind = bus::RawKind::kSample;
    Timestamp time;     // when it arrived here
    Timestamp written;  // by the writer's clock
    std::vector<std::byte> cdr;
};

struct WriterOptions {
    /// Ends in .mcap. Further files have a number before the ending: world-2.mcap. Numbers whose
    /// files exist already are left out.
    std::filesystem::path file;
    std::string world;
    std::string host;
    std::string version;
    std::uint64_t cut_bytes = 0;            // begins a new file then; 0: never
    std::chrono::nanoseconds cut_after{0};  // likewise
};

/// Writes the samples of a world into MCAP files (docs/recording.md).
///
/// Each topic has three channels: `SiteMesh` for samples, and for ends of instances
/// `SiteMesh/disposed` and `SiteMesh/lost`, whose messages have only the key fields. What is kept
/// (`is_kept`) lies in chunks of its own. The channel `recorder` says, as JSON, what was recorded
/// and dropped. Each file begins with all that is kept at that time and can be played alone.
///
/// One thread at a time.
class WorldWriter {
public:
    static Expected<WorldWriter> create(WriterOptions options);

    Expected<void> write(const Recorded& sample);
    /// Writes a line of JSON about the recording itself.
    Expected<void> note(Timestamp time, const std::string& json);
    /// Writes what waited for `kFlushAfter`. Call it several times a second.
    Expected<void> flush_due(std::chrono::steady_clock::time_point now);
    /// Ends the file in order.
    Expected<void> finish();

    /// Longest time that a message waits for its chunk: a killed process loses no more.
    static constexpr std::chrono::milliseconds kFlushAfter{400};

    const std::vector<std::filesystem::path>& files() const { return files_; }
    std::uint64_t num_bytes() const;  // of all files
    /// Samples that were given to `write` and are in no file, because their chunk could not be
    /// written; by topic.
    std::map<std::string, std::uint64_t> lost() const;

private:
    explicit WorldWriter(WriterOptions options) : options_(std::move(options)) {}
    bool cuts() const { return options_.cut_bytes > 0 || options_.cut_after.count() > 0; }
    Expected<void> begin_file(Timestamp time);
    Expected<std::uint16_t> channel_of(const bus::RawTopic& topic, bus::RawKind kind);
    Expected<void> put(const Recorded& sample, Timestamp time);
    Expected<void> put_message(std::size_t lane, const mcap::Message& message);
    Expected<void> cut_if_due(Timestamp time);
    void keep(const Recorded& sample, std::string key);

    WriterOptions options_;
    std::optional<mcap::Writer> out_;
    std::vector<std::filesystem::path> files_;
    std::size_t last_number_ = 0;  // in the name of the newest file
    std::uint64_t bytes_of_former_ = 0;
    std::map<std::string, std::uint16_t, std::less<>> schemas_;
    std::map<std::pair<const bus::RawTopic*, bus::RawKind>, std::uint16_t> channels_;
    std::optional<std::uint16_t> notes_;
    std::map<std::uint16_t, std::uint32_t> sequences_;
    /// Since when each lane holds a message that is not in the file.
    std::vector<std::optional<std::chrono::steady_clock::time_point>> unflushed_since_;
    /// Samples for which a file had no room, by topic.
    std::map<std::string, std::uint64_t> not_begun_;

    /// The newest sample of each instance that is kept, by topic and key: for the next file.
    std::map<std::pair<const bus::RawTopic*, std::string>, Recorded> kept_;
    std::size_t kept_bytes_ = 0;
    std::optional<Timestamp> file_begin_;
};

/// "world-2.mcap" of "world.mcap" for part 2; part 1 has the name as it is.
std::filesystem::path part_name(const std::filesystem::path& file, std::size_t part);

}  // namespace atrium::recording
