#pragma once

#include "core/app/lasting_log.hpp"
#include "site_node/capture/metaframe.hpp"
#include "site_node/record/instant_numbers.hpp"
#include "site_node/record/picture_queue.hpp"

#include <chrono>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace atrium::record {

struct RecorderOptions {
    capture::RawCodec codec = capture::RawCodec::kHuffYuv;
    double rate_hz = 30.0;                    // of the instants
    std::size_t bytes_per_instant = 0;        // about, of all cameras
    double queue_s = 1.0;                     // between capture and the disk
    double pre_roll_s = 0.0;                  // what came before `start`
    std::uint64_t memory_bytes = 1U << 30;    // limit for both
    std::uint64_t min_free_bytes = 1U << 30;  // the recording ends before the disk has less
    int num_threads = 1;
};

/// Error kConfiguration if the memory does not suffice for queue and pre-roll.
Expected<void> check_memory(const RecorderOptions& options, std::size_t num_cameras);

/// Writes the pictures of a site's cameras to disk, as they come. Never holds up capture: copies
/// each picture into memory, where its own threads take it. If the pictures of an instant find no
/// place there, all of them are dropped and counted, in the log and in the recording.
class RawRecorder {
public:
    /// Errors of `check_memory`.
    static Expected<std::unique_ptr<RawRecorder>> create(RecordedRoom room,
                                                         const RecorderOptions& options,
                                                         FileCalls calls = system_calls());
    /// Stops a recording.
    ~RawRecorder();

    /// Takes a picture, or that a picture was lost. One thread at a time.
    void add(const capture::CameraFrame& frame);

    /// Begins a recording in `folder`, which must be empty or new, with the pre-roll. Errors:
    /// kConfiguration also while another one runs, kUnavailable if the folder cannot be written or
    /// the disk is too full. Thread-safe, as all below.
    Expected<void> start(const std::filesystem::path& folder);

    /// Ends the recording when all that came is written. Nothing to do without one. Returns the
    /// error of `result`.
    Expected<void> stop();

    bool is_recording() const;

    /// Of the newest recording, in rig order; empty: there was none.
    std::vector<RecordedPictures> counters() const;

    /// Error kInternal if a recording ended before `stop`: the disk is full, or failed.
    Expected<void> result() const;

private:
    using Session = PictureQueue::Session;

    RawRecorder(RecordedRoom room,
                const RecorderOptions& options,
                FileCalls calls,
                const PictureQueue::Options& queue);
    void begin_numbers(const Session& session);
    bool is_kept(const PictureToWrite& picture);
    void write_pictures(std::size_t writer, const std::stop_token& stop);
    void look_after(const std::stop_token& stop);
    void look(const Session& session);
    void end(const Session& session);
    std::uint64_t bytes_per_s() const;

    RecordedRoom room_;
    RecorderOptions options_;
    FileCalls calls_;
    PictureQueue queue_;
    app::log::LastingLog drops_;

    std::mutex control_mutex_;  // of start, stop and the end after a failure
    std::mutex add_mutex_;      // while a picture is added: neither start nor end come between
    mutable std::mutex mutex_;  // of all below
    Session session_;           // null: nothing is recorded
    Session last_session_;      // also after its end
    InstantNumbers numbers_;
    std::uint64_t base_ = 0;                       // number of the session's first instant
    std::vector<std::uint64_t> next_;              // per camera: after its newest number
    std::vector<std::size_t> picture_bytes_;       // per camera, of its newest picture
    std::optional<std::uint64_t> newest_instant_;  // of those that were decided
    std::deque<std::uint64_t> dropped_instants_;   // the newest ones
    Expected<void> result_;

    struct Told {
        Session session;
        std::uint64_t num_dropped = 0;
        std::uint64_t num_bytes = 0;
    } told_;  // of the thread that looks after

    std::vector<std::jthread> threads_;  // last: they use all above
};

}  // namespace atrium::record
