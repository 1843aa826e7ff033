#pragma once

#include "site_node/capture/frame_source.hpp"
#include "site_node/capture/recorded_times.hpp"
#include "site_node/capture/recording_track.hpp"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::capture {

struct RecordingOptions {
    std::filesystem::path folder;
    double rate_hz = 0.0;   // 0: as recorded (times.csv, else rate_hz of rig.toml)
    bool loop = false;      // restart after the last frame
    std::size_t every = 1;  // plays each Nth instant; at the recorded rate, N periods apart
    /// Does not keep a pace: the sink blocks until it wants the next instant. At most 400 a second.
    bool as_fast_as_possible = false;
    bool ignore_silhouettes = false;  // neither read nor checked
    /// False: a folder without rig.toml is taken, too (`rig_of_pictures`).
    bool needs_rig = true;
    /// Receives the reason for each picture that is left out: its file, number and what is wrong.
    /// For a truncated or damaged video, one reason for all.
    std::function<void(const std::string&)> report_unreadable = {};
};

/// Fails if there is no such folder, or if it is the file of a recorded world.
Expected<void> check_is_room(const std::filesystem::path& folder);

/// Plays a recording of raw pictures, image sequences or video files in real time
/// (docs/conventions.md, "Recordings").
///
/// A missing or unreadable picture leaves its metaframe incomplete; it is not an error of the
/// source. Pictures of another size than the rig says are one, when it is opened.
class RecordingSource final : public FrameSource {
public:
    static Expected<std::unique_ptr<RecordingSource>> open(const RecordingOptions& options);
    ~RecordingSource() override;

    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return has_silhouettes_; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override;
    Expected<void> run(std::stop_token stop, const Sink& sink) override;
    /// Counts delivered pictures as received, missing or unreadable ones as incomplete.
    std::vector<CameraCounters> camera_counters() const override { return counters_.counters(); }

    /// Number of frames of the camera with the most frames; for a video the number in its header,
    /// or of whole pictures if it is truncated.
    std::size_t num_frames() const override { return num_frames_; }

    /// Instants per second as they were recorded; 0: their times are not known.
    double recorded_hz() const;

    bool has_empty_room(std::size_t camera) const override;
    std::filesystem::path learned_rooms() const override;

    /// Instants of the recording that `run` has passed in this round. Thread-safe.
    std::size_t num_passed() const override { return std::min(next_index_.load(), num_frames_); }

    /// Reads frame `index` of every camera except those in `without`, for tools. The error names
    /// the first camera that lacks it.
    Expected<Metaframe> read_frame(std::size_t index, const std::vector<std::string>& without = {});

    Expected<CameraFrame> read_picture(std::size_t camera, std::size_t index) override;

private:
    explicit RecordingSource(config::Rig rig);
    Expected<void> load_times();
    Expected<void> show_background_of(std::size_t camera,
                                      const BackgroundSink& sink,
                                      const std::stop_token& stop);
    std::optional<CameraFrame> next_frame(std::size_t camera, std::size_t index);

    RecordingOptions options_;
    config::Rig rig_;
    DeliveryCounters counters_;
    bool has_silhouettes_ = false;
    std::size_t num_frames_ = 0;
    std::atomic<std::size_t> next_index_{0};
    std::vector<std::unique_ptr<RecordingTrack>> tracks_;  // one per camera
    RecordedTimes times_ns_;                               // empty without times.csv
    // short looping recordings stay decoded: playback then costs as much as live cameras
    std::vector<std::vector<std::optional<CameraFrame>>> decoded_;  // [frame][camera]
};

}  // namespace atrium::capture
