#include "site_node/silhouette_writer.hpp"

#include "core/app/log.hpp"
#include "core/app/progress.hpp"
#include "site_node/capture/mask_file.hpp"
#include "site_node/capture/recording_source.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"
#include "site_node/start_check.hpp"
#include "site_node/views/views_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>

namespace atrium::site_node {
namespace {

namespace fs = std::filesystem;
using Tally = segmentation_worker::WorkerTally;

Expected<void> prepare_folder(const fs::path& folder, bool overwrite) {
    std::error_code problem;
    if (!overwrite && fs::exists(folder, problem) && !fs::is_empty(folder, problem)) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("--write-silhouettes: '{}' is not empty; add --overwrite to write into it",
                        folder.string()));
    }
    fs::create_directories(folder, problem);
    if (problem) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("{}: cannot create: {}", folder.string(), problem.message()));
    }
    return {};
}

// Segments the pictures of one camera and writes them to files.
class CameraWriter {
public:
    CameraWriter(const geometry::CalibratedCamera& camera, SilhouetteStage stage, fs::path folder)
        : camera_(camera), stage_(std::move(stage)), folder_(std::move(folder)) {}

    /// The view has no contours if the camera sees nobody.
    Expected<views::NamedView> write(capture::CameraFrame frame, std::size_t number) {
        if (auto done = stage_.find(frame, {}, found_); !done) return tl::unexpected(done.error());
        const fs::path file = capture::numbered_png(folder_, number);
        if (auto done = capture::write_mask(found_.mask.mask, file); !done)
            return tl::unexpected(done.error());
        return views::NamedView{
            camera_.name, {camera_.intrinsics, camera_.camera_from_site, found_.contours, {}}};
    }

private:
    geometry::CalibratedCamera camera_;
    SilhouetteStage stage_;
    fs::path folder_;
    PictureSilhouette found_;
};

Expected<std::vector<CameraWriter>> make_writers(capture::FrameSource& source,
                                                 const SiteNodeConfig& config,
                                                 const std::shared_ptr<Tally>& tally,
                                                 const std::stop_token& stop) {
    std::vector<CameraWriter> writers;
    auto stages = make_silhouette_stages(source, all_cameras(source), config.pipeline, stop, tally);
    for (std::size_t i = 0; i < stages.size(); ++i) {
        const geometry::CalibratedCamera& camera = source.rig().cameras[i];
        if (!stages[i]) return tl::unexpected(stages[i].error());
        const fs::path folder = config.write_silhouettes / camera.name / "silhouettes";
        std::error_code problem;
        fs::create_directories(folder, problem);
        if (problem) {
            return make_error(
                ErrorKind::kUnavailable,
                fmt::format("{}: cannot create: {}", folder.string(), problem.message()));
        }
        writers.emplace_back(camera, std::move(*stages[i]), folder);
    }
    return writers;
}

// Skips cameras without a picture.
Expected<std::size_t> write_metaframe(capture::RecordingSource& source,
                                      std::size_t index,
                                      std::vector<CameraWriter>& writers,
                                      const fs::path& views_folder) {
    std::vector<views::NamedView> views;
    for (std::size_t i = 0; i < writers.size(); ++i) {
        auto frame = source.read_picture(i, index);
        if (!frame) continue;
        auto view = writers[i].write(std::move(*frame), index);
        if (!view) return tl::unexpected(view.error());
        views.push_back(std::move(*view));
    }
    if (views.empty()) return std::size_t{0};
    const fs::path file = views_folder / fmt::format("{:06d}.json", index);
    if (auto saved = views::save_views_file(views, file); !saved)
        return tl::unexpected(saved.error());
    return views.size();
}

}  // namespace

Expected<void> write_silhouettes(const SiteNodeConfig& config, std::stop_token stop) {
    if (config.capture.source != "recording") {
        return make_error(ErrorKind::kConfiguration,
                          "--write-silhouettes: needs a recording; add --recording DIR");
    }
    if (auto found = check_places(config); !found) return found;
    if (const auto rig = load_checked_rig(config); !rig) return tl::unexpected(rig.error());
    auto source = capture::RecordingSource::open(
        {.folder = config.capture.recording, .ignore_silhouettes = true});
    if (!source) return tl::unexpected(source.error());
    if (auto fits = check_areas(config.pipeline, (*source)->rig()); !fits) return fits;
    const fs::path& folder = config.write_silhouettes;
    if (auto ready = prepare_folder(folder, config.overwrite); !ready) return ready;
    const segmentation_worker::WorkerOptions& worker = config.pipeline.worker;
    const auto tally =
        worker.socket.empty() ? nullptr : std::make_shared<Tally>(worker.deadline_ms);
    auto writers = make_writers(**source, config, tally, stop);
    if (!writers) {
        if (stop.stop_requested()) return {};
        return tl::unexpected(writers.error());
    }
    const fs::path views_folder = folder / "views";
    std::error_code problem;
    fs::create_directories(views_folder, problem);
    std::size_t num_metaframes = 0;
    std::size_t num_pictures = 0;
    std::size_t num_missing = 0;
    const auto every = static_cast<std::size_t>(config.capture.every);
    app::Progress progress("frame", (*source)->num_frames());
    for (std::size_t i = 0; i < (*source)->num_frames() && !stop.stop_requested(); i += every) {
        const auto written = write_metaframe(**source, i, *writers, views_folder);
        if (!written) return tl::unexpected(written.error());
        num_metaframes += *written > 0 ? 1 : 0;
        num_pictures += *written;
        num_missing += writers->size() - *written;
        if (const auto line = progress.update(i + 1))
            app::log::info("writing silhouettes {}", *line);
    }
    app::log::info("wrote silhouettes folder={} metaframes={} pictures={}",
                   folder.string(),
                   num_metaframes,
                   num_pictures);
    if (tally != nullptr) app::log::info("segmentation_worker {}", tally->line());
    if (num_missing > 0) {
        app::log::warn("pictures were missing or unreadable and are not in the output pictures={}",
                       num_missing);
    }
    if (num_pictures == 0 && !stop.stop_requested()) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("recording '{}': no picture can be read",
                                      config.capture.recording.string()));
    }
    return {};
}

}  // namespace atrium::site_node
