#include "tools/calibrate/sweep/sweep.hpp"

#include "core/base/latest_slot.hpp"
#include "core/base/thread_pool.hpp"
#include "site_node/capture/timed_assembler.hpp"
#include "site_node/preview/preview.hpp"
#include "site_node/source/open_source.hpp"
#include "tools/calibrate/sweep/detect_lights.hpp"
#include "tools/calibrate/sweep/sweep_preview.hpp"
#include "tools/calibrate/sweep/sweep_progress.hpp"
#include "tools/calibrate/sweep/sweep_tally.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kMostThreads = 8;

// Looks at one instant after the other.
class Watcher {
public:
    Watcher(const SweepOptions& options, SweepTally tally)
        : tally_(std::move(tally)),
          buffers_(tally_.cameras().size()),
          seen_(tally_.cameras().size()),
          pool_(std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, kMostThreads)) {
        for (std::size_t c = 0; c < buffers_.size(); ++c)
            detectors_.emplace_back(DetectionOptions{options.light_threshold});
        if (options.preview.empty()) return;
        std::vector<std::string> names;
        for (std::size_t c = 0; c < buffers_.size(); ++c) names.push_back(tally_.name(c));
        target_ = options.preview;
        preview_ = std::make_unique<preview::Preview>(target_, std::move(names));
    }

    // `load(camera)` makes the picture, if it is not there, on any thread.
    template <typename Load>
    void look(capture::Metaframe& instant, const Load& load) {
        const auto look_at = [&](std::size_t c, std::size_t) {
            load(c);
            seen_[c].reset();
            const image::RawImage& image = instant.frames[c].image;
            if (image.empty()) return;
            detectors_[c].detect(image::working_view(image, buffers_[c]), seen_[c].emplace());
        };
        pool_.parallel_for(buffers_.size(), look_at);
        tally_.add(static_cast<std::uint32_t>(instant.frame_id), seen_);
        progress_.update(tally_);
        if (preview_ == nullptr) return;
        last_ = instant;
        if (preview_->wants_shot()) preview_->show(views_of(instant, tally_));
    }

    // Leaves the last instant in the file of the preview.
    void end() {
        preview_.reset();
        if (last_.frames.empty() || !target_.has_extension()) return;
        preview::Picture picture;
        preview::draw(views_of(last_, tally_), picture);
        if (auto written = preview::write_png(target_, picture); !written)
            progress_.say("check: " + written.error().message);
    }

    SweepTally& tally() { return tally_; }
    SweepProgress& progress() { return progress_; }

private:
    SweepTally tally_;
    std::vector<LightDetector> detectors_;
    std::vector<image::YuvImage> buffers_;
    std::vector<std::optional<DetectedLights>> seen_;
    SweepProgress progress_;
    std::filesystem::path target_;
    capture::Metaframe last_;
    std::unique_ptr<preview::Preview> preview_;
    ThreadPool pool_;
};

void watch_recording(capture::FrameSource& source,
                     std::size_t every,
                     Watcher& watcher,
                     const std::stop_token& stop) {
    const std::size_t num_cameras = source.rig().cameras.size();
    for (std::size_t i = 0; i < source.num_frames() && !stop.stop_requested(); i += every) {
        capture::Metaframe instant;
        instant.frame_id = i;
        instant.frames.resize(num_cameras);
        watcher.look(instant, [&](std::size_t c) {
            instant.frames[c].camera = c;
            // a missing or damaged picture is one that this camera did not deliver
            if (auto picture = source.read_picture(c, i)) instant.frames[c] = std::move(*picture);
        });
    }
}

Expected<void> watch_live(capture::FrameSource& source,
                          const site_node::CaptureConfig& capture,
                          Watcher& watcher,
                          const std::stop_token& stop) {
    const std::size_t num_cameras = source.rig().cameras.size();
    const double quarter_period_ms = 250.0 / source.rig().rate_hz;
    const auto from_ms = [](double ms) {
        return std::chrono::nanoseconds(static_cast<std::int64_t>(ms * 1e6));
    };
    LatestSlot<capture::Metaframe> slot;
    capture::TimedAssembler assembler(
        num_cameras,
        {.tolerance =
             from_ms(capture.tolerance_ms > 0.0 ? std::min(capture.tolerance_ms, quarter_period_ms)
                                                : quarter_period_ms),
         .deadline = from_ms(capture.deadline_ms),
         .min_cameras = 2},
        [&](std::optional<capture::Metaframe> instant, const capture::MetaframeAssembler&) {
            if (instant) slot.put(std::move(*instant));
        });
    std::stop_source end;
    const std::stop_callback pass_on(stop, [&end] { end.request_stop(); });
    std::mutex result_mutex;
    Expected<void> result;
    std::jthread runner([&] {
        auto done = source.run(
            end.get_token(), [&](capture::CameraFrame frame) { assembler.add(std::move(frame)); });
        const std::lock_guard lock(result_mutex);
        result = std::move(done);
        end.request_stop();
    });
    while (!end.stop_requested() && !watcher.tally().is_complete()) {
        auto instant = slot.take_until(end.get_token(), watcher.progress().due());
        if (instant) {
            watcher.look(*instant, [](std::size_t) {});
        } else {
            watcher.progress().update(watcher.tally());
        }
    }
    end.request_stop();
    runner.join();
    const std::lock_guard lock(result_mutex);
    return result;
}

}  // namespace

Expected<Sweep> record_sweep(const SweepOptions& options, const Wand& wand, std::stop_token stop) {
    Sweep sweep;
    const auto source = site_node::open_uncalibrated_source(options.capture, options.room, stop);
    if (!source) return tl::unexpected(source.error());
    const config::Rig& rig = (*source)->rig();
    sweep.rate_hz = rig.rate_hz;
    for (const geometry::CalibratedCamera& camera : rig.cameras)
        sweep.cameras.push_back(
            {camera.name, camera.intrinsics.width, camera.intrinsics.height, 0.0});
    auto tally = SweepTally::make(wand, sweep.cameras, {options.num_instants, rig.rate_hz});
    if (!tally) return tl::unexpected(tally.error());
    Watcher watcher(options, std::move(*tally));
    watcher.progress().say(
        fmt::format("sweep: {} cameras; sweep the wand through the whole space "
                    "and turn it; Ctrl-C ends the sweep and solves",
                    sweep.cameras.size()));
    Expected<void> watched;
    if ((*source)->num_frames() > 0) {
        watch_recording(**source, static_cast<std::size_t>(options.capture.every), watcher, stop);
    } else {
        watched = watch_live(**source, options.capture, watcher, stop);
    }
    watcher.end();
    if (!watched) return tl::unexpected(watched.error());
    watcher.progress().say(watcher.tally().progress());
    if (const std::string why = watcher.tally().why_too_little(); !why.empty())
        return make_error(ErrorKind::kInvalidData, why);
    sweep.points = watcher.tally().points();
    return sweep;
}

}  // namespace atrium::calibrate
