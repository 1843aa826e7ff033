#include "site_node/backgrounds.hpp"

#include "core/app/log.hpp"
#include "site_node/segmentation/background_file.hpp"
#include "site_node/segmentation/background_quality.hpp"
#include "site_node/segmentation/segmentation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>

namespace atrium::site_node {
namespace {

using segmentation::BackgroundStatistics;

// So many of the last empty pictures are segmented with what was learned.
constexpr std::size_t kNumChecked = 4;

// A picture that outlives what it was shown as.
struct KeptPicture {
    image::YuvImage planes;
    image::Mosaic mosaic = image::Mosaic::kNone;

    void keep(const image::YuvView& view) {
        mosaic = view.mosaic;
        copy(view.y, planes.y);
        copy(view.u, planes.u);
        copy(view.v, planes.v);
    }
    image::YuvView view() const {
        image::YuvView result(planes);
        result.mosaic = mosaic;
        return result;
    }

private:
    static void copy(const image::PlaneView& from, image::Plane& to) {
        if (to.width != from.width || to.height != from.height)
            to = image::Plane(from.width, from.height);
        for (int y = 0; y < from.height; ++y) std::copy_n(from.row(y), from.width, to.row(y));
    }
};

// Learns, keeps the last pictures, and says once a second how far it is.
class ToldLearner {
public:
    ToldLearner(const std::string& camera, int max_frames, std::stop_token stop)
        : camera_(camera), max_frames_(max_frames), stop_(std::move(stop)) {}

    void add(const image::YuvView& picture) {
        if (!result_ || stop_.stop_requested()) return;
        if (max_frames_ > 0 && learner_.num_frames() >= max_frames_) return;
        result_ = learner_.add(picture);
        if (!result_) return;
        if (last_.size() < kNumChecked) {
            last_.emplace_back();
        } else {
            std::rotate(last_.begin(), last_.begin() + 1, last_.end());
        }
        last_.back().keep(picture);
        if (const auto now = Clock::now(); now - told_ >= std::chrono::seconds(1)) {
            told_ = now;
            app::log::info(
                "learning the empty room camera={} pictures={}", camera_, learner_.num_frames());
        }
    }

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
    using Clock = std::chrono::steady_clock;
    std::string camera_;
    int max_frames_;
    std::stop_token stop_;
    segmentation::BackgroundLearner learner_;
    Expected<void> result_;
    std::deque<KeptPicture> last_;
    Clock::time_point told_ = Clock::now();
};

Error with_camera(const Error& error, const std::string& camera) {
    return {error.kind, fmt::format("camera '{}': no background: {}", camera, error.message)};
}

Expected<BackgroundStatistics> learn(capture::FrameSource& source,
                                     std::size_t camera,
                                     const BackgroundOptions& options,
                                     const segmentation::SegmentationOptions& segmentation,
                                     const std::stop_token& stop) {
    const std::string& name = source.rig().cameras[camera].name;
    ToldLearner learner(name, options.num_frames, stop);
    const auto shown = source.show_background(
        camera, [&](const image::YuvView& picture) { learner.add(picture); });
    if (stop.stop_requested())
        return make_error(ErrorKind::kUnavailable, "stopped while learning the empty room");
    if (!shown) return tl::unexpected(with_camera(shown.error(), name));
    auto room = learner.finish();
    if (!room) return tl::unexpected(with_camera(room.error(), name));
    const auto quality = segmentation::background_quality(*room, segmentation);
    app::log::info(
        "learned the empty room camera={} pictures={} noise={:.2f} coverage={:.3f} "
        "foreground={:.5f}",
        name,
        room->num_frames,
        quality.noise,
        quality.coverage,
        learner.foreground_share(*room, segmentation));
    return room;
}

Expected<void> check_size(const BackgroundStatistics& room,
                          const geometry::CalibratedCamera& camera,
                          const std::filesystem::path& folder) {
    const auto& size = camera.intrinsics;
    if (room.width == (size.width & ~1) && room.height == (size.height & ~1)) return {};
    return make_error(
        ErrorKind::kConfiguration,
        fmt::format("{}: was learned at {}x{} px, the camera has {}x{}: learn it anew with "
                    "--learn-background",
                    segmentation::background_file(folder, camera.name).string(),
                    room.width,
                    room.height,
                    size.width,
                    size.height));
}

}  // namespace

Expected<BackgroundStatistics> load_or_learn_background(
    capture::FrameSource& source,
    std::size_t camera,
    const BackgroundOptions& options,
    const segmentation::SegmentationOptions& segmentation,
    std::stop_token stop) {
    if (options.folder.empty()) return learn(source, camera, options, segmentation, stop);
    const auto& calibrated = source.rig().cameras[camera];
    auto room = segmentation::load_background(options.folder, calibrated.name);
    if (!room && room.error().kind == ErrorKind::kNotFound) {
        app::log::warn("nothing learned yet camera={} reason=\"{}\"; learning for this run only",
                       calibrated.name,
                       room.error().message);
        return learn(source, camera, options, segmentation, stop);
    }
    if (!room) return tl::unexpected(with_camera(room.error(), calibrated.name));
    if (auto fits = check_size(*room, calibrated, options.folder); !fits)
        return tl::unexpected(with_camera(fits.error(), calibrated.name));
    app::log::info(
        "empty room as learned before camera={} pictures={}", calibrated.name, room->num_frames);
    return room;
}

Expected<void> learn_backgrounds(capture::FrameSource& source,
                                 const BackgroundOptions& options,
                                 const segmentation::SegmentationOptions& segmentation,
                                 std::stop_token stop) {
    if (options.folder.empty()) {
        return make_error(
            ErrorKind::kConfiguration,
            "segmentation.background_folder: is needed to keep what --learn-background learns");
    }
    if (source.has_silhouettes()) {
        return make_error(ErrorKind::kConfiguration,
                          "--learn-background: this recording has silhouettes; there is nothing to "
                          "learn");
    }
    for (std::size_t camera = 0; camera < source.rig().cameras.size(); ++camera) {
        const auto room = learn(source, camera, options, segmentation, stop);
        if (!room) return tl::unexpected(room.error());
        const std::string& name = source.rig().cameras[camera].name;
        auto saved = segmentation::save_background(*room, options.folder, name);
        if (!saved) return saved;
    }
    app::log::info("kept the empty room folder={}", options.folder.string());
    return {};
}

segmentation::SegmentationAreas areas_of(const std::vector<CameraAreas>& areas,
                                         const std::string& name) {
    segmentation::SegmentationAreas sum;
    for (const CameraAreas& camera : areas) {
        if (camera.name != name) continue;
        sum.include.insert(
            sum.include.end(), camera.areas.include.begin(), camera.areas.include.end());
        sum.exclude.insert(
            sum.exclude.end(), camera.areas.exclude.begin(), camera.areas.exclude.end());
    }
    return sum;
}

}  // namespace atrium::site_node
