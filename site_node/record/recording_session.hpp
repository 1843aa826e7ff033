#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "site_node/record/camera_file.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace atrium::record {

/// What a recording holds besides its pictures.
struct RecordedRoom {
    std::string site;
    config::Rig rig;
    /// One per camera, null: there is none. Must stay valid.
    std::vector<const segmentation::BackgroundStatistics*> rooms;
    std::string settings;  // of the site, as text
};

/// Checks that a recording can begin in `folder`: it is new or empty and can be written. Errors as
/// RecordingSession::create.
Expected<void> check_new_folder(const std::filesystem::path& folder);

/// Counts the pictures of one camera since the start of a recording.
struct RecordedPictures {
    std::uint64_t num_written = 0;
    std::uint64_t num_dropped = 0;    // they came, but are not in the recording
    std::uint64_t num_lost = 0;       // never came, but other cameras showed their instants
    std::uint64_t num_bytes = 0;      // written
    std::uint64_t num_raw_bytes = 0;  // of the same pictures, as they came

    bool operator==(const RecordedPictures&) const = default;
};

/// A picture on its way to the disk.
struct PictureToWrite {
    std::size_t camera = 0;
    std::uint64_t number = 0;
    Timestamp capture_time;
    capture::RawLayout layout;
    std::vector<std::uint8_t> packed;
};

/// The files of one recording (docs/conventions.md, "Recordings"). Thread-safe, but the pictures of
/// one camera must come in order from one thread.
class RecordingSession {
public:
    /// Creates the folder with all but the pictures. Errors: kConfiguration if it is not empty,
    /// kUnavailable if it cannot be written.
    static Expected<std::unique_ptr<RecordingSession>> create(const std::filesystem::path& folder,
                                                              const RecordedRoom& room,
                                                              capture::RawCodec codec,
                                                              const FileCalls& calls);

    const std::filesystem::path& folder() const { return folder_; }

    /// Writes a picture. After a failure it only counts it as dropped.
    void write(const PictureToWrite& picture);

    /// Notes a picture that is not written.
    void note_dropped(std::size_t camera, std::uint64_t number, Timestamp capture_time);
    /// Counts pictures of instants that other cameras showed.
    void note_lost(std::size_t camera, std::uint64_t num_pictures);

    /// Why nothing is written any more; empty: all is well.
    std::string failure() const;
    /// Ends the writing. The first reason counts.
    void fail(const std::string& reason);

    /// Writes times and counts: what was noted survives the end of the process.
    void save();
    /// The last `save`, with how the recording ended.
    void finish();

    std::vector<RecordedPictures> counters() const;

private:
    struct Camera {
        std::string name;
        std::unique_ptr<CameraFile> file;  // of the writing thread
        RecordedPictures counts;
    };
    RecordingSession(std::filesystem::path folder,
                     const RecordedRoom& room,
                     capture::RawCodec codec,
                     const FileCalls& calls);
    Expected<void> write_fixed_files(const RecordedRoom& room);
    Expected<std::uint64_t> append(const PictureToWrite& picture);
    void add_time(std::size_t camera, std::uint64_t number, Timestamp time, const char* state);
    Expected<void> save_times();
    std::string summary(const char* state) const;

    std::filesystem::path folder_;
    std::string site_;
    capture::RawCodec codec_;
    FileCalls calls_;
    Timestamp begin_;
    Descriptor times_file_{-1};
    std::mutex save_mutex_;
    mutable std::mutex mutex_;  // of what follows; files of pictures need none
    std::vector<Camera> cameras_;
    std::string times_;  // lines that are not written yet
    std::string failure_;
};

}  // namespace atrium::record
