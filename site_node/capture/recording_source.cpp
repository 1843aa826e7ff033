#include "site_node/capture/recording_source.hpp"

#include "core/base/looked_up.hpp"
#include "site_node/capture/mask_file.hpp"
#include "site_node/capture/pace.hpp"
#include "site_node/capture/picture_file.hpp"
#include "site_node/capture/rig_of_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>

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

std::optional<std::int64_t> parse_integer(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
    std::int64_t value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

// Pictures lose an odd last row or column.
bool fits(const PictureSize& size, const geometry::PinholeCamera& expected) {
    return (size.width & ~1) == (expected.width & ~1) &&
           (size.height & ~1) == (expected.height & ~1);
}

tl::unexpected<Error> wrong_size(const fs::path& file,
                                 const std::string& what_has,
                                 const PictureSize& size,
                                 const geometry::PinholeCamera& expected) {
    return make_error(ErrorKind::kInvalidData,
                      fmt::format("{}: {} {}x{} px, but rig.toml says {}x{}: correct width and "
                                  "height, and scale fx, fy, cx and cy if the calibration is of "
                                  "the other size",
                                  file.string(),
                                  what_has,
                                  size.width,
                                  size.height,
                                  expected.width,
                                  expected.height));
}

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

// Pictures of one camera, and optional masks beside them.
class RecordingSource::Track {
public:
    static Expected<std::unique_ptr<Track>> open(const fs::path& folder,
                                                 const geometry::PinholeCamera& expected,
                                                 bool ignore_masks) {
        auto track = std::make_unique<Track>();
        track->expected_ = expected;
        auto pictures = PictureFile::find(folder, "frames");
        if (!pictures) return tl::unexpected(pictures.error());
        track->pictures_ = std::move(*pictures);
        if (const auto size = track->pictures_.size(); size && !fits(*size, expected))
            return wrong_size(track->pictures_.path(), "the pictures have", *size, expected);
        if (!ignore_masks && fs::is_directory(folder / "silhouettes")) {
            auto masks = PictureFile::find(folder, "silhouettes");
            if (!masks) return tl::unexpected(masks.error());
            track->masks_ = std::move(*masks);
            image::Mask mask;
            const std::size_t first = track->masks_->first_picture();
            if (auto read = track->masks_->read_mask(first, mask); !read)
                return tl::unexpected(read.error());
            if (auto fits = track->check_mask(mask, first); !fits)
                return tl::unexpected(fits.error());
            track->has_inverted_masks_ = looks_inverted(mask);
        }
        return track;
    }

    std::size_t num_frames() const { return pictures_.num_pictures(); }
    std::string what_is_missing() const {
        const std::string reason = pictures_.what_is_missing();
        return reason.empty() && masks_ ? masks_->what_is_missing() : reason;
    }
    bool is_video() const { return pictures_.is_video(); }
    bool has_masks() const { return masks_.has_value(); }
    bool has_inverted_masks() const { return has_inverted_masks_; }

    Expected<CameraFrame> read(std::size_t index) {
        CameraFrame frame;
        auto picture = std::make_shared<image::YuvImage>();
        if (auto read = pictures_.read(index, *picture); !read) return tl::unexpected(read.error());
        const PictureSize size = pictures_.size_read();
        if (!fits(size, expected_))
            return wrong_size(
                pictures_.path(), fmt::format("frame {} has", index), size, expected_);
        if (masks_) {
            auto mask = std::make_shared<image::Mask>();
            if (auto read = masks_->read_mask(index, *mask); !read)
                return tl::unexpected(read.error());
            if (auto fits = check_mask(*mask, index); !fits) return tl::unexpected(fits.error());
            frame.silhouette = std::move(mask);
        }
        frame.image = image::RawImage(std::move(picture));
        return frame;
    }

private:
    Expected<void> check_mask(const image::Mask& mask, std::size_t index) const {
        if (mask.width == (expected_.width & ~1) && mask.height == (expected_.height & ~1))
            return {};
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("{}: mask {} has {}x{} px, but the pictures of this camera have {}x{} "
                        "(rig.toml): scale the masks without smoothing, for example with "
                        "mogrify -filter point -resize '{}x{}!' {}/*.png",
                        masks_->path().string(),
                        index,
                        mask.width,
                        mask.height,
                        expected_.width,
                        expected_.height,
                        expected_.width,
                        expected_.height,
                        masks_->path().string()));
    }

    geometry::PinholeCamera expected_;
    PictureFile pictures_;
    std::optional<PictureFile> masks_;
    bool has_inverted_masks_ = false;
};

RecordingSource::RecordingSource(config::Rig rig) : rig_(std::move(rig)), counters_(rig_) {}

RecordingSource::~RecordingSource() = default;

Expected<std::unique_ptr<RecordingSource>> RecordingSource::open(const RecordingOptions& options) {
    if (!fs::is_directory(options.folder)) {
        return make_error(ErrorKind::kNotFound,
                          fmt::format("recording '{}': no such folder{}",
                                      options.folder.string(),
                                      looked_up_from(options.folder)));
    }
    const bool has_rig = options.needs_rig || fs::exists(options.folder / "rig.toml");
    auto rig = has_rig ? config::load_rig(options.folder) : rig_of_pictures(options.folder);
    if (!rig) return tl::unexpected(rig.error());
    std::unique_ptr<RecordingSource> source(new RecordingSource(std::move(*rig)));
    source->options_ = options;
    std::size_t num_with_masks = 0;
    for (const auto& camera : source->rig_.cameras) {
        auto track = Track::open(
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

Expected<void> RecordingSource::load_times() {
    const fs::path file = options_.folder / "times.csv";
    if (!fs::exists(file)) return {};
    std::ifstream stream(file);
    if (!stream)
        return make_error(ErrorKind::kNotFound, fmt::format("{}: cannot open", file.string()));
    times_ns_.assign(num_frames_, std::vector<std::optional<std::int64_t>>(tracks_.size()));
    std::string line;
    for (std::size_t number = 1; std::getline(stream, line); ++number) {
        if (line.empty() || line == "\r" || (number == 1 && line.rfind("frame", 0) == 0)) continue;
        const auto wrong = [&](const std::string& what) {
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("{}:{}: {}", file.string(), number, what));
        };
        const std::size_t first = line.find(',');
        const std::size_t second = first == std::string::npos ? first : line.find(',', first + 1);
        if (second == std::string::npos) return wrong("expected: frame, camera, capture_time_ns");
        const auto frame = parse_integer(std::string_view(line).substr(0, first));
        const auto time = parse_integer(std::string_view(line).substr(second + 1));
        std::string name = line.substr(first + 1, second - first - 1);
        std::erase(name, ' ');
        const auto camera = std::find_if(rig_.cameras.begin(),
                                         rig_.cameras.end(),
                                         [&](const auto& c) { return c.name == name; });
        if (!frame || *frame < 0 || !time)
            return wrong("frame and capture_time_ns must be integers");
        if (camera == rig_.cameras.end())
            return wrong(fmt::format("rig.toml has no camera '{}'", name));
        if (static_cast<std::size_t>(*frame) >= num_frames_) continue;
        times_ns_[static_cast<std::size_t>(*frame)]
                 [static_cast<std::size_t>(camera - rig_.cameras.begin())] = *time;
    }
    return check_times(times_ns_, file);
}

bool RecordingSource::has_empty_room(std::size_t camera) const {
    const auto found = PictureFile::find(options_.folder / rig_.cameras[camera].name, "background");
    // a damaged file is an error of show_background, not a missing one
    return found || found.error().kind != ErrorKind::kNotFound;
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
    const bool recorded_times = options_.rate_hz <= 0.0 && !times_ns_.empty();
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
