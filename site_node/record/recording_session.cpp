#include "site_node/record/recording_session.hpp"

#include "core/base/write_check.hpp"
#include "core/config/rig_text.hpp"
#include "site_node/capture/recording_track.hpp"
#include "site_node/segmentation/background_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

namespace atrium::record {
namespace {

namespace fs = std::filesystem;

// Besides pictures: rooms of 64 cameras, times.
constexpr std::uint64_t kLeastBytes = 64U << 20;

Expected<void> write_whole(const fs::path& file, const std::string& text) {
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    stream << text;
    stream.close();
    if (stream) return {};
    return tl::unexpected(cannot_write(file, "write", errno));
}

// A crash leaves the former text.
Expected<void> replace(const fs::path& file, const std::string& text) {
    const fs::path next = file.string() + ".next";
    if (auto written = write_whole(next, text); !written) return written;
    std::error_code failure;
    fs::rename(next, file, failure);
    if (failure) return tl::unexpected(cannot_write(file, "write", failure.value()));
    return {};
}

// Text in a TOML string.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
    return out + "\"";
}

}  // namespace

Expected<void> check_new_folder(const fs::path& folder) {
    std::error_code failure;
    if (fs::exists(folder, failure) && !fs::is_directory(folder, failure)) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("--record: '{}' is no folder", folder.string()));
    }
    if (fs::is_directory(folder, failure) && !fs::is_empty(folder, failure)) {
        const bool is_recording = fs::exists(folder / "rig.toml", failure);
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("--record: '{}' {}; give a new folder",
                                      folder.string(),
                                      is_recording ? "holds a recording already" : "is not empty"));
    }
    return check_folder_writable(folder, kLeastBytes, "--record");
}

RecordingSession::RecordingSession(fs::path folder,
                                   const RecordedRoom& room,
                                   capture::RawCodec codec,
                                   const FileCalls& calls)
    : folder_(std::move(folder)),
      site_(room.site),
      codec_(codec),
      calls_(calls),
      begin_(Timestamp::now()),
      cameras_(room.rig.cameras.size()) {
    for (std::size_t i = 0; i < cameras_.size(); ++i) cameras_[i].name = room.rig.cameras[i].name;
}

Expected<std::unique_ptr<RecordingSession>> RecordingSession::create(const fs::path& folder,
                                                                     const RecordedRoom& room,
                                                                     capture::RawCodec codec,
                                                                     const FileCalls& calls) {
    if (auto fits = check_new_folder(folder); !fits) return tl::unexpected(fits.error());
    std::error_code failure;
    fs::create_directories(folder, failure);
    if (failure) return tl::unexpected(cannot_write(folder, "create", failure.value()));
    std::unique_ptr<RecordingSession> session(new RecordingSession(folder, room, codec, calls));
    if (auto written = session->write_fixed_files(room); !written)
        return tl::unexpected(written.error());
    return session;
}

Expected<void> RecordingSession::write_fixed_files(const RecordedRoom& room) {
    for (const Camera& camera : cameras_) {
        const fs::path own = folder_ / camera.name;
        std::error_code failure;
        fs::create_directory(own, failure);
        if (failure) return tl::unexpected(cannot_write(own, "create", failure.value()));
    }
    for (std::size_t i = 0; i < room.rooms.size(); ++i) {
        if (room.rooms[i] == nullptr) continue;
        if (auto saved = segmentation::save_background(
                *room.rooms[i], folder_ / capture::kRoomsName, cameras_[i].name);
            !saved)
            return saved;
    }
    if (!room.settings.empty()) {
        if (auto written = write_whole(folder_ / "settings.txt", room.settings); !written)
            return written;
    }
    const fs::path times = folder_ / "times.csv";
    times_file_ =
        Descriptor(open(times.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_APPEND | O_CLOEXEC, 0644));
    if (times_file_.get() < 0) return tl::unexpected(cannot_write(times, "create", errno));
    times_ = "frame,camera,capture_time_ns\n";
    if (auto saved = save_times(); !saved) return saved;
    if (auto written = replace(folder_ / capture::kSummaryName, summary("running")); !written)
        return written;
    config::Rig rig = room.rig;
    if (!rig.has_bounds) rig.bounds_site = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    return write_whole(folder_ / "rig.toml",
                       config::rig_text(rig, {"Recorded by site_node: docs/recording_rooms.md"}));
}

Expected<std::uint64_t> RecordingSession::append(const PictureToWrite& picture) {
    Camera& camera = cameras_[picture.camera];
    if (camera.file == nullptr) {
        auto file = CameraFile::create(
            folder_ / camera.name / capture::kRawFileName, picture.layout, codec_, calls_);
        if (!file) return tl::unexpected(file.error());
        camera.file = std::make_unique<CameraFile>(std::move(*file));
    }
    if (picture.layout != camera.file->layout()) return 0;  // the camera was set up otherwise
    return camera.file->append(picture.number, picture.capture_time, picture.packed);
}

void RecordingSession::write(const PictureToWrite& picture) {
    if (failure().empty()) {
        const auto num_bytes = append(picture);
        if (num_bytes && *num_bytes > 0) {
            const std::lock_guard lock(mutex_);
            Camera& camera = cameras_[picture.camera];
            ++camera.counts.num_written;
            camera.counts.num_bytes += *num_bytes;
            camera.counts.num_raw_bytes += picture.packed.size();
            add_time(picture.camera, picture.number, picture.capture_time, "");
            return;
        }
        if (!num_bytes) fail(num_bytes.error().message);
    }
    note_dropped(picture.camera, picture.number, picture.capture_time);
}

void RecordingSession::add_time(std::size_t camera,
                                std::uint64_t number,
                                Timestamp time,
                                const char* state) {
    fmt::format_to(
        std::back_inserter(times_), "{},{},{}{}\n", number, cameras_[camera].name, time.ns, state);
}

void RecordingSession::note_dropped(std::size_t camera,
                                    std::uint64_t number,
                                    Timestamp capture_time) {
    const std::lock_guard lock(mutex_);
    ++cameras_[camera].counts.num_dropped;
    if (failure_.empty()) add_time(camera, number, capture_time, ",dropped");
}

void RecordingSession::note_lost(std::size_t camera, std::uint64_t num_pictures) {
    const std::lock_guard lock(mutex_);
    cameras_[camera].counts.num_lost += num_pictures;
}

std::string RecordingSession::failure() const {
    const std::lock_guard lock(mutex_);
    return failure_;
}

void RecordingSession::fail(const std::string& reason) {
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) failure_ = reason;
}

Expected<void> RecordingSession::save_times() {
    std::string lines;
    {
        const std::lock_guard lock(mutex_);
        lines.swap(times_);
    }
    std::size_t done = 0;
    while (done < lines.size()) {
        const ssize_t written =
            ::write(times_file_.get(), lines.data() + done, lines.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0)
            return tl::unexpected(
                cannot_write(folder_ / "times.csv", "write", written < 0 ? errno : ENOSPC));
        done += static_cast<std::size_t>(written);
    }
    return {};
}

void RecordingSession::save() {
    const std::lock_guard lock(save_mutex_);
    if (auto saved = save_times(); !saved) fail(saved.error().message);
    if (auto saved = replace(folder_ / capture::kSummaryName, summary("running")); !saved)
        fail(saved.error().message);
}

void RecordingSession::finish() {
    const std::lock_guard lock(save_mutex_);
    if (auto saved = save_times(); !saved) fail(saved.error().message);
    const char* state = failure().empty() ? "complete" : "ended";
    if (auto saved = replace(folder_ / capture::kSummaryName, summary(state)); !saved)
        fail(saved.error().message);
}

std::vector<RecordedPictures> RecordingSession::counters() const {
    const std::lock_guard lock(mutex_);
    std::vector<RecordedPictures> all;
    for (const Camera& camera : cameras_) all.push_back(camera.counts);
    return all;
}

std::string RecordingSession::summary(const char* state) const {
    const std::vector<RecordedPictures> counts = counters();
    std::string text = fmt::format(
        "# How this recording was made; renewed once a second: docs/recording_rooms.md\n"
        "site = {}\nstate = \"{}\"\nreason = {}\ncodec = \"{}\"\nbegin_ns = {}\nnewest_ns = {}\n",
        quoted(site_),
        state,
        quoted(failure()),
        capture::name_of(codec_),
        begin_.ns,
        Timestamp::now().ns);
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        text += fmt::format(
            "\n[[camera]]\nname = \"{}\"\nwritten = {}\ndropped = {}\nlost = {}\nbytes = {}\n",
            cameras_[i].name,
            counts[i].num_written,
            counts[i].num_dropped,
            counts[i].num_lost,
            counts[i].num_bytes);
    }
    return text;
}

}  // namespace atrium::record
