#include "site_node/silhouette_stage/backgrounds.hpp"

#include "core/app/log.hpp"
#include "site_node/segmentation/background_file.hpp"
#include "site_node/segmentation/background_quality.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "site_node/silhouette_stage/kept_picture.hpp"
#include "site_node/silhouette_stage/occupied_backgrounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <numeric>

namespace atrium::site_node {
namespace {

using segmentation::BackgroundStatistics;

// Number of last empty pictures that are segmented to check the model.
constexpr std::size_t kNumChecked = 4;

// Learns one camera and keeps its last pictures.
class CameraLearner {
public:
    explicit CameraLearner(int max_frames) : max_frames_(max_frames) {}

    /// Returns false when no more pictures are wanted.
    bool add(const image::YuvView& picture) {
        result_ = learner_.add(picture);
        if (!result_) return false;
        if (last_.size() < kNumChecked) {
            last_.emplace_back();
        } else {
            std::rotate(last_.begin(), last_.begin() + 1, last_.end());
        }
        last_.back().keep(picture);
        return max_frames_ == 0 || num_frames() < max_frames_;
    }

    int num_frames() const { return learner_.num_frames(); }

    Expected<BackgroundStatistics> finish() const {
        if (!result_) return tl::unexpected(result_.error());
        return learner_.finish();
    }

    double foreground_share(const BackgroundStatistics& room,
                            const segmentation::SegmentationOptions& options) const {
        segmentation::Segmenter segmenter(room, options);
        image::Mask mask;
        double foreground = 0.0;
        for (const KeptPicture& picture : last_) {
            if (!segmenter.segment(picture.view(), mask)) continue;
            foreground += static_cast<double>(
                std::count(mask.data.begin(), mask.data.end(), std::uint8_t{255}));
        }
        return foreground / static_cast<double>(room.luma.size() * last_.size());
    }

private:
    int max_frames_;  // 0: any number
    segmentation::BackgroundLearner learner_;
    Expected<void> result_;
    std::deque<KeptPicture> last_;
};

Error with_camera(const Error& error, const std::string& camera) {
    return {error.kind, fmt::format("camera '{}': no background: {}", camera, error.message)};
}

// Learns the given cameras in the order in which the source shows them. Logs progress once a
// second.
class RoomLearner {
public:
    RoomLearner(capture::FrameSource& source,
                std::vector<std::size_t> cameras,
                const BackgroundOptions& options,
                const segmentation::SegmentationOptions& segmentation)
        : source_(source), cameras_(std::move(cameras)), segmentation_(segmentation) {
        const bool is_default = options.num_frames == 0 && source.is_live();
        num_wanted_ = is_default ? BackgroundOptions::kNumLiveFrames : options.num_frames;
        learners_.assign(source.rig().cameras.size(), CameraLearner(num_wanted_));
    }

    /// Results are in the order of `cameras`.
    std::vector<Expected<BackgroundStatistics>> learn(const std::stop_token& stop) {
        const auto learn_from = [this](std::size_t camera, const image::YuvView& picture) {
            const bool go_on = learners_[camera].add(picture);
            log_progress();
            return go_on;
        };
        const auto shown = source_.show_background(cameras_, learn_from, stop);
        std::vector<Expected<BackgroundStatistics>> rooms;
        for (std::size_t i = 0; i < cameras_.size(); ++i)
            rooms.push_back(finish(cameras_[i], shown[i], stop));
        return rooms;
    }

private:
    using Clock = std::chrono::steady_clock;

    void log_progress() {
        const auto now = Clock::now();
        if (now - last_log_ < std::chrono::seconds(1)) return;
        last_log_ = now;
        std::string pictures;
        for (const std::size_t camera : cameras_) {
            pictures += fmt::format(
                " {}={}", source_.rig().cameras[camera].name, learners_[camera].num_frames());
        }
        app::log::info("learning the empty room pictures=\"{}\"{}",
                       std::string_view(pictures).substr(1),
                       num_wanted_ > 0 ? fmt::format(" of={}", num_wanted_) : "");
    }

    Expected<BackgroundStatistics> finish(std::size_t camera,
                                          const Expected<void>& shown,
                                          const std::stop_token& stop) const {
        const std::string& name = source_.rig().cameras[camera].name;
        if (!shown && stop.stop_requested())
            return make_error(ErrorKind::kUnavailable, "stopped while learning the empty room");
        if (!shown) return tl::unexpected(with_camera(shown.error(), name));
        auto room = learners_[camera].finish();
        if (!room) return tl::unexpected(with_camera(room.error(), name));
        const auto quality = segmentation::background_quality(*room, segmentation_);
        app::log::info(
            "learned the empty room camera={} pictures={} noise={:.2f} coverage={:.3f} "
            "false_foreground={:.3f}%",
            name,
            room->num_frames,
            quality.noise,
            quality.coverage,
            100.0 * learners_[camera].foreground_share(*room, segmentation_));
        if (source_.is_live() && quality.noise == 0.0) {
            app::log::warn(
                "the pictures of the empty room have no noise, unlike those of any sensor "
                "camera={}; check that they show what the camera sees",
                name);
        }
        return room;
    }

    capture::FrameSource& source_;
    std::vector<std::size_t> cameras_;
    const segmentation::SegmentationOptions& segmentation_;
    int num_wanted_ = 0;                   // 0: every picture shown
    std::vector<CameraLearner> learners_;  // per camera of the rig
    Clock::time_point last_log_ = Clock::now();
};

// Live cameras learn in parallel, others one after the other to hold only one model in memory.
std::vector<Expected<BackgroundStatistics>> learn_empty(
    capture::FrameSource& source,
    const std::vector<std::size_t>& cameras,
    const BackgroundOptions& options,
    const segmentation::SegmentationOptions& segmentation,
    const std::stop_token& stop) {
    if (source.is_live()) return RoomLearner(source, cameras, options, segmentation).learn(stop);
    std::vector<Expected<BackgroundStatistics>> rooms;
    for (const std::size_t camera : cameras) {
        auto room = RoomLearner(source, {camera}, options, segmentation).learn(stop);
        rooms.push_back(std::move(room.front()));
    }
    return rooms;
}

// Learns from pictures of the empty room or of the room with people in it, as the options and the
// source say.
std::vector<Expected<BackgroundStatistics>> learn(
    capture::FrameSource& source,
    const std::vector<std::size_t>& cameras,
    const BackgroundOptions& options,
    const segmentation::SegmentationOptions& segmentation,
    const std::stop_token& stop) {
    std::vector<std::size_t> with_people;
    for (const std::size_t camera : cameras) {
        if (options.from == "people" || (options.from == "auto" && !source.has_empty_room(camera)))
            with_people.push_back(camera);
    }
    if (with_people.empty()) return learn_empty(source, cameras, options, segmentation, stop);
    auto learned = learn_with_people(source, with_people, options, segmentation, stop);
    std::vector<std::size_t> empty;
    for (const std::size_t camera : cameras) {
        if (std::find(with_people.begin(), with_people.end(), camera) == with_people.end())
            empty.push_back(camera);
    }
    auto others = learn_empty(source, empty, options, segmentation, stop);
    std::vector<Expected<BackgroundStatistics>> rooms;
    auto next_with_people = learned.begin();
    auto next_other = others.begin();
    for (const std::size_t camera : cameras) {
        const bool is_other =
            next_other != others.end() &&
            empty[static_cast<std::size_t>(next_other - others.begin())] == camera;
        rooms.push_back(std::move(*(is_other ? next_other++ : next_with_people++)));
    }
    return rooms;
}

Expected<void> check_size(const BackgroundStatistics& room,
                          const geometry::CalibratedCamera& camera,
                          const std::filesystem::path& folder) {
    const auto& size = camera.intrinsics;
    if (room.width == (size.width & ~1) && room.height == (size.height & ~1)) return {};
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("{}: learned at {}x{} px, but the camera has {}x{}: learn again "
                                  "with --learn-background",
                                  segmentation::background_file(folder, camera.name).string(),
                                  room.width,
                                  room.height,
                                  size.width,
                                  size.height));
}

// Error kNotFound only if no background was kept.
Expected<BackgroundStatistics> load(const std::filesystem::path& folder,
                                    const geometry::CalibratedCamera& camera) {
    auto room = segmentation::load_background(folder, camera.name);
    if (!room) return tl::unexpected(with_camera(room.error(), camera.name));
    if (auto fits = check_size(*room, camera, folder); !fits)
        return tl::unexpected(with_camera(fits.error(), camera.name));
    app::log::info(
        "empty room as learned before camera={} pictures={}", camera.name, room->num_frames);
    return room;
}

}  // namespace

std::vector<Expected<BackgroundStatistics>> load_or_learn_backgrounds(
    capture::FrameSource& source,
    const std::vector<std::size_t>& cameras,
    const BackgroundOptions& asked,
    const segmentation::SegmentationOptions& segmentation,
    std::stop_token stop) {
    BackgroundOptions options = asked;
    if (options.folder.empty() && options.from == "auto") options.folder = source.learned_rooms();
    if (options.folder.empty()) return learn(source, cameras, options, segmentation, stop);
    std::vector<Expected<BackgroundStatistics>> rooms(cameras.size());
    std::vector<std::size_t> unknown;  // entries of `cameras`
    std::vector<std::size_t> unknown_cameras;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        rooms[i] = load(options.folder, source.rig().cameras[cameras[i]]);
        if (rooms[i] || rooms[i].error().kind != ErrorKind::kNotFound) continue;
        unknown.push_back(i);
        unknown_cameras.push_back(cameras[i]);
    }
    if (unknown.empty()) return rooms;
    std::string names;
    for (const std::size_t camera : unknown_cameras)
        names += (names.empty() ? "" : ", ") + source.rig().cameras[camera].name;
    app::log::warn(
        "nothing learned yet cameras=\"{0}\" folder={1}; learning for this run only, which keeps "
        "nothing: to keep it, run once with --learn-background --segmentation.background_folder "
        "{1}",
        names,
        options.folder.string());
    auto learned = learn(source, unknown_cameras, options, segmentation, stop);
    for (std::size_t i = 0; i < unknown.size(); ++i) rooms[unknown[i]] = std::move(learned[i]);
    return rooms;
}

Expected<void> learn_backgrounds(capture::FrameSource& source,
                                 const BackgroundOptions& options,
                                 const segmentation::SegmentationOptions& segmentation,
                                 std::stop_token stop) {
    if (options.folder.empty()) {
        return make_error(
            ErrorKind::kConfiguration,
            "segmentation.background_folder: must be set to keep what --learn-background learns");
    }
    if (source.has_silhouettes()) {
        return make_error(
            ErrorKind::kConfiguration,
            "--learn-background: this recording has silhouettes and needs no background");
    }
    std::vector<std::size_t> all(source.rig().cameras.size());
    std::iota(all.begin(), all.end(), 0);
    const auto rooms = learn(source, all, options, segmentation, stop);
    if (stop.stop_requested())
        return make_error(ErrorKind::kUnavailable, "stopped while learning; nothing was kept");
    Expected<void> result;
    for (std::size_t camera = 0; camera < rooms.size(); ++camera) {
        const std::string& name = source.rig().cameras[camera].name;
        const Expected<void> saved =
            rooms[camera] ? segmentation::save_background(*rooms[camera], options.folder, name)
                          : tl::unexpected(rooms[camera].error());
        if (result) result = saved;
    }
    if (result) app::log::info("kept the empty room folder={}", options.folder.string());
    return result;
}

}  // namespace atrium::site_node
