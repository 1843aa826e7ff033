#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/recording/world_writer.hpp"

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace atrium::recording {

struct RecorderOptions {
    WriterOptions writer;
    std::set<std::string> sites;   // only what belongs to these sites, and to none; empty: all
    std::set<std::string> topics;  // only these; empty: all but PersonProxy
    std::uint64_t buffer_bytes = std::uint64_t{64} << 20U;      // of samples that wait for the disk
    std::uint64_t spare_disk_bytes = std::uint64_t{64} << 20U;  // left free on the disk
};

struct RecorderCounters {
    std::uint64_t num_samples = 0;                 // recorded
    std::uint64_t num_bytes = 0;                   // of these, uncompressed
    std::uint64_t num_dropped = 0;                 // the disk did not keep up
    std::map<std::string, std::uint64_t> dropped;  // by topic
    std::uint64_t num_rejected = 0;                // samples without a valid key
    std::uint64_t waiting_bytes = 0;
    std::uint64_t file_bytes = 0;
    std::vector<std::filesystem::path> files;
    std::set<std::string> sites;        // that are recorded
    std::set<std::string> other_sites;  // that were heard, and are not asked for
};

/// Records the topics of a world. Only listens: no other program notices it, but sites send it
/// their streams as to one more viewer.
///
/// Two threads: one takes samples and puts them in line, one writes. The line is bounded: if the
/// disk does not keep up, the newest sample is dropped and counted, also in the file.
class Recorder {
public:
    static Expected<std::unique_ptr<Recorder>> create(const bus::Participant& participant,
                                                      RecorderOptions options);
    ~Recorder();
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// Records until the stop, or until the disk is full (kUnavailable): the file is then complete
    /// up to there. Ends the file in order.
    Expected<void> run(std::stop_token stop);
    /// Thread-safe.
    RecorderCounters counters() const;

private:
    struct Source {
        const bus::RawTopic* topic;
        std::unique_ptr<bus::RawReader> reader;
    };
    Recorder(RecorderOptions options,
             WorldWriter writer,
             bus::Waiter waiter,
             std::vector<Source> sources);
    void take();
    void receive(const bus::RawTopic& topic, const bus::RawSample& sample);
    void put_in_line();
    void drop(const bus::RawTopic& topic);  // with the lock held
    Timestamp now() const;
    void write_until_stopped();
    Expected<void> write_some();
    Expected<void> check_disk();
    std::string note() const;

    RecorderOptions options_;
    WorldWriter writer_;  // of the writing thread
    bus::Waiter waiter_;
    std::vector<Source> sources_;
    std::vector<Recorded> batch_;  // of one `take`
    std::uint64_t batch_bytes_ = 0;
    // The times of a recording go on evenly, also when the host's clock is set.
    Timestamp begin_ = Timestamp::now();
    std::chrono::steady_clock::time_point steady_begin_ = std::chrono::steady_clock::now();

    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<Recorded> line_;  // guarded by mutex_, like all below
    std::uint64_t waiting_bytes_ = 0;
    RecorderCounters counters_;
    Expected<void> written_;
    bool is_over_ = false;  // no further samples come
};

}  // namespace atrium::recording
