#include "site_node/capture/recording_source.hpp"

#include "core/base/looked_up.hpp"
#include "site_node/capture/pace.hpp"
#include "site_node/capture/picture_file.hpp"
#include "site_node/capture/rig_of_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::capture {
namespace {

namespace fs = std::filesystem;

// Looping recordings up to this size stay decoded.
constexpr std::size_t kMaxDecodedBytes = std::size_t{1} << 30;
constexpr std::size_t kMaxFrames = 10'000'000;
// Between metaframes, in periods: longer breaks of a recording are shortened.
constexpr int kLongestGap = 10;
// As fast as possible: keeps the times of metaframes apart.
constexpr std::chrono::nanoseconds kLeastGap = std::chrono::microseconds(2500);

// The pictures of the camera have the rig's size, so the plate is wrong.
tl::unexpected<Error> wrong_plate(const fs::path& file,
                                  std::size_t index,
                                  const PictureSize& size,
                                  const geometry::PinholeCamera& expected) {
    return make_error(
        ErrorKind::kInvalidData,
        fmt::format("{0}: picture {1} of the empty room has {2}x{3} px, but the pictures of this "
                    "camera have {4}x{5} (rig.toml): film the empty room with the same settings of "
                    "the camera, or scale it as a whole to {4}x{5}",
                    file.string(),
                    index,
                    size.width,
                    size.height,
                    expected.width,
                    expected.height));
}

}  // namespace

Expected<void> check_is_room(const fs::path& folder) {
    if (folder.extension() == ".mcap") {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("recording '{}': this is a recording of a world: play it with "
                        "play or viewer; a site plays the folder of a room",
                        folder.string()));
    }
    if (!fs::is_directory(folder)) {
        return make_error(
            ErrorKind::kNotFound,
            fmt::format(
                "recording '{}': no such folder{}", folder.string(), looked_up_from(folder)));
    }
    return {};
}

RecordingSource::RecordingSource(config::Rig rig) : rig_(std::move(rig)), counters_(rig_) {}

RecordingSource::~RecordingSource() = default;

Expected<std::unique_ptr<RecordingSource>> RecordingSource::open(const RecordingOptions& options) {
    if (auto room = check_is_room(options.folder); !room) return tl::unexpected(room.error());
    const bool has_rig = options.needs_rig || fs::exists(options.folder / "rig.toml");
    auto rig = has_rig ? config::load_rig(options.folder) : rig_of_pictures(options.folder);
    if (!rig) return tl::unexpected(rig.error());
    std::unique_ptr<RecordingSource> source(new RecordingSource(std::move(*rig)));
    source->options_ = options;
    std::size_t num_with_masks = 0;
    for (const auto& camera : source->rig_.cameras) {
        auto track = RecordingTrack::open(
            options.folder / camera.name, camera.intrinsics, options.ignore_silhouettes);
        if (!track) return tl::unexpected(track.error());
        source->num_frames_ = std::max(source->num_frames_, (*track)->num_frames());
        if (const std::string reason = (*track)->what_is_missing();
            options.report_unreadable && !reason.empty())
            options.report_unreadable(fmt::format("camera '{}': {}", camera.name, reason));
        num_with_masks += (*track)->has_masks() ? 1 : 0;
        source->tracks_.push_back(std::move(*track));
    }
    if (num_with_masks != 0 && num_with_masks != source->tracks_.size()) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("recording '{}': some cameras have silhouettes/ and others do not",
                        options.folder.string()));
    }
    source->has_silhouettes_ = num_with_masks != 0;
    // one camera may be close to somebody, all of them cannot
    if (std::ranges::all_of(source->tracks_,
                            [](const auto& track) { return track->has_inverted_masks(); })) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("recording '{0}': the masks look inverted: white covers the borders of the "
                        "pictures, but people must be white; if `calibrate import` made it, import "
                        "again with --invert-masks; else mogrify -negate {0}/*/silhouettes/*.png",
                        options.folder.string()));
    }
    if (source->num_frames_ == 0 || source->num_frames_ > kMaxFrames) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("recording '{}': holds no frames", options.folder.string()));
    }
    if (auto loaded = source->load_times(); !loaded) return tl::unexpected(loaded.error());
    return source;
}

// The times in the pictures' own files win: after a crash the others may lack the last ones.
Expected<void> RecordingSource::load_times() {
    const fs::path file = options_.folder / "times.csv";
    if (fs::exists(file)) {
        auto times = read_times(file, rig_, num_frames_);
        if (!times) return tl::unexpected(times.error());
        times_ns_ = std::move(*times);
    }
    for (std::size_t camera = 0; camera < tracks_.size(); ++camera) {
        for (std::size_t index = 0; index < tracks_[camera]->num_frames(); ++index) {
            const auto time = tracks_[camera]->capture_time(index);
            if (!time) continue;
            if (times_ns_.empty())
                times_ns_.assign(num_frames_,
                                 std::vector<std::optional<std::int64_t>>(tracks_.size()));
            times_ns_[index][camera] = time->ns;
        }
    }
    return check_times(times_ns_, file);
}

bool RecordingSource::has_empty_room(std::size_t camera) const {
    const auto found = PictureFile::find(options_.folder / rig_.cameras[camera].name, "background");
    // a damaged file is an error of show_background, not a missing one
    return found || found.error().kind != ErrorKind::kNotFound;
}

fs::path RecordingSource::learned_rooms() const {
    const fs::path rooms = options_.folder / kRoomsName;
    std::error_code failure;
    return fs::is_directory(rooms, failure) ? rooms : fs::path();
}

std::vector<Expected<void>> RecordingSource::show_background(
    const std::vector<std::size_t>& cameras, const BackgroundSink& sink, std::stop_token stop) {
    return one_after_another(
        cameras, [&](std::size_t camera) { return show_background_of(camera, sink, stop); }, stop);
}

Expected<void> RecordingSource::show_background_of(std::size_t camera,
                                                   const BackgroundSink& sink,
                                                   const std::stop_token& stop) {
    const fs::path folder = options_.folder / rig_.cameras[camera].name;
    auto pictures = PictureFile::find(folder, "background");
    if (!pictures) return tl::unexpected(pictures.error());
    image::YuvImage picture;
    for (std::size_t i = 0; i < pictures->num_pictures() && !stop.stop_requested(); ++i) {
        if (pictures->has_lost(i)) continue;
        if (auto read = pictures->read(i, picture); !read) {
            // a video header may announce more frames than the file has
            if (i > 0 && pictures->is_video()) break;
            return tl::unexpected(read.error());
        }
        const PictureSize size = pictures->size_read();
        if (const auto& expected = rig_.cameras[camera].intrinsics; !fits(size, expected))
            return wrong_plate(pictures->path(), i, size, expected);
        if (!sink(camera, picture)) break;
    }
    return {};
}

double RecordingSource::recorded_hz() const {
    std::vector<std::int64_t> times;  // of the first camera that has one, of each instant
    for (const auto& of_cameras : times_ns_) {
        const auto known =
            std::ranges::find_if(of_cameras, [](const auto& time) { return time.has_value(); });
        if (known != of_cameras.end()) times.push_back(**known);
    }
    std::vector<std::int64_t> periods;
    for (std::size_t i = 1; i < times.size(); ++i) periods.push_back(times[i] - times[i - 1]);
    if (periods.empty()) return 0.0;
    const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
    std::ranges::nth_element(periods, middle);
    return *middle > 0 ? 1e9 / static_cast<double>(*middle) : 0.0;
}

std::optional<CameraFrame> RecordingSource::next_frame(std::size_t camera, std::size_t index) {
    if (!decoded_.empty() && decoded_[index][camera]) return decoded_[index][camera];
    auto frame = tracks_[camera]->read(index);
    if (!frame) {
        // a video header may announce more frames than the file has
        const bool is_end =
            frame.error().kind == ErrorKind::kNotFound && tracks_[camera]->is_video();
        if (options_.report_unreadable && !is_end) {
            options_.report_unreadable(
                fmt::format("camera '{}': {}", rig_.cameras[camera].name, frame.error().message));
        }
        return std::nullopt;
    }
    frame->camera = camera;
    if (!decoded_.empty()) decoded_[index][camera] = *frame;
    return std::move(*frame);
}

Expected<void> RecordingSource::run(std::stop_token stop, const Sink& sink) {
    const double rate_hz = options_.rate_hz > 0.0 ? options_.rate_hz : rig_.rate_hz;
    // without another rate, every Nth instant keeps its time
    const std::size_t step = options_.rate_hz > 0.0 ? 1 : options_.every;
    const std::chrono::nanoseconds period(
        static_cast<std::int64_t>(1e9 / rate_hz * static_cast<double>(step)));
    std::size_t bytes_per_frame = 0;
    for (const auto& camera : rig_.cameras) {
        bytes_per_frame +=
            static_cast<std::size_t>(camera.intrinsics.width * camera.intrinsics.height) * 5 / 2;
    }
    if (options_.loop &&
        num_frames_ <= kMaxDecodedBytes / std::max<std::size_t>(bytes_per_frame, 1)) {
        decoded_.assign(num_frames_, std::vector<std::optional<CameraFrame>>(tracks_.size()));
    }
    // without a pace, instants are closer together than the cameras' times within one
    const bool recorded_times =
        options_.rate_hz <= 0.0 && !times_ns_.empty() && !options_.as_fast_as_possible;
    const auto offset_of = [&](std::size_t index,
                               std::size_t camera) -> std::optional<std::int64_t> {
        return recorded_times ? times_ns_[index][camera] : std::nullopt;
    };
    Pace pace(options_.as_fast_as_possible ? kLeastGap : period);
    do {
        std::optional<std::int64_t> former_ns;
        std::size_t num_read = 0;
        for (std::size_t index = 0; index < num_frames_; index += options_.every) {
            next_index_ = index + options_.every;
            std::vector<CameraFrame> frames;
            for (std::size_t camera = 0; camera < tracks_.size() && !stop.stop_requested();
                 ++camera) {
                if (auto frame = next_frame(camera, index)) {
                    frames.push_back(std::move(*frame));
                } else {
                    counters_.count_incomplete(camera);
                }
            }
            num_read += frames.size();
            std::optional<std::int64_t> first_ns;
            for (const CameraFrame& frame : frames) {
                if (const auto t = offset_of(index, frame.camera))
                    first_ns = std::min(first_ns.value_or(*t), *t);
            }
            const auto since_former =
                first_ns && former_ns ? std::chrono::nanoseconds(*first_ns - *former_ns) : period;
            former_ns = first_ns;
            if (!pace.wait(stop,
                           options_.as_fast_as_possible ? kLeastGap
                                                        : std::clamp(since_former,
                                                                     std::chrono::nanoseconds(0),
                                                                     kLongestGap * period)))
                return {};
            const Timestamp now = pace.due_time();
            for (CameraFrame& frame : frames) {
                const auto own_ns = offset_of(index, frame.camera);
                frame.capture_time = own_ns ? Timestamp{now.ns + (*own_ns - *first_ns)} : now;
                counters_.count_received(frame.camera);
                sink(std::move(frame));
            }
        }
        if (num_read == 0) {
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format("recording '{}': no picture can be read", options_.folder.string()));
        }
    } while (options_.loop);
    return {};
}

Expected<CameraFrame> RecordingSource::read_picture(std::size_t camera, std::size_t index) {
    auto frame = tracks_[camera]->read(index);
    if (frame) frame->camera = camera;
    return frame;
}

Expected<Metaframe> RecordingSource::read_frame(std::size_t index,
                                                const std::vector<std::string>& without) {
    if (index >= num_frames_) {
        return make_error(ErrorKind::kNotFound,
                          fmt::format("recording '{}' has frames 0 to {}, not {}",
                                      options_.folder.string(),
                                      num_frames_ - 1,
                                      index));
    }
    Metaframe metaframe;
    metaframe.frame_id = index;
    for (std::size_t camera = 0; camera < tracks_.size(); ++camera) {
        const bool is_excluded =
            std::find(without.begin(), without.end(), rig_.cameras[camera].name) != without.end();
        if (is_excluded) {
            metaframe.frames.push_back({camera, {}, {}, nullptr});
            continue;
        }
        auto frame = read_picture(camera, index);
        if (!frame) return tl::unexpected(frame.error());
        metaframe.frames.push_back(std::move(*frame));
    }
    return metaframe;
}

}  // namespace atrium::capture
