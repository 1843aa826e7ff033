#include "tools/calibrate/sweep/watch.hpp"

#include "core/base/latest_slot.hpp"
#include "core/base/thread_pool.hpp"
#include "site_node/capture/timed_assembler.hpp"
#include "site_node/preview/preview.hpp"
#include "tools/calibrate/sweep/sweep_progress.hpp"

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kMostThreads = 8;

// Shows one instant after the other to the observer, and what it says to the user.
class Watcher {
public:
    Watcher(const SourceOptions& options, Observer& observer)
        : observer_(observer),
          target_(options.preview),
          pool_(std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, kMostThreads)) {
        if (target_.empty()) return;
        std::vector<std::string> names;
        for (const NominalCamera& camera : observer.cameras()) names.push_back(camera.name);
        preview_ = std::make_unique<preview::Preview>(target_, std::move(names));
    }

    // `load(camera)` makes the picture, if it is not there, on any thread.
    template <typename Load>
    void look(capture::Metaframe& instant, const Load& load) {
        const auto look_at = [&](std::size_t c, std::size_t) {
            load(c);
            observer_.look(c, instant.frames[c].image);
        };
        pool_.parallel_for(instant.frames.size(), look_at);
        observer_.count(instant);
        progress_.update(observer_);
        if (preview_ == nullptr) return;
        last_ = instant;
        if (preview_->wants_shot()) preview_->show(observer_.views(instant));
    }

    // Leaves the last instant in the file of the preview, and the last line on the terminal.
    void end() {
        preview_.reset();
        if (!last_.frames.empty() && target_.has_extension()) {
            preview::Picture picture;
            preview::draw(observer_.views(last_), picture);
            if (auto written = preview::write_png(target_, picture); !written)
                progress_.say("check: " + written.error().message);
        }
        progress_.say(observer_.progress(0));
    }

    Observer& observer() { return observer_; }
    SweepProgress& progress() { return progress_; }

private:
    Observer& observer_;
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
        instant.capture_time.ns =
            static_cast<std::int64_t>(static_cast<double>(i) / source.rig().rate_hz * 1e9);
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
         .min_cameras = std::min<std::size_t>(2, num_cameras)},
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
    while (!end.stop_requested() && !watcher.observer().is_complete()) {
        auto instant = slot.take_until(end.get_token(), watcher.progress().due());
        if (instant) {
            watcher.look(*instant, [](std::size_t) {});
        } else {
            watcher.progress().update(watcher.observer());
        }
    }
    end.request_stop();
    runner.join();
    const std::lock_guard lock(result_mutex);
    return result;
}

}  // namespace

std::vector<NominalCamera> nominal_cameras(const config::Rig& rig) {
    std::vector<NominalCamera> cameras;
    for (const geometry::CalibratedCamera& camera : rig.cameras)
        cameras.push_back({camera.name, camera.intrinsics.width, camera.intrinsics.height, 0.0});
    return cameras;
}

Expected<void> watch(capture::FrameSource& source,
                     const SourceOptions& options,
                     Observer& observer,
                     std::stop_token stop) {
    Watcher watcher(options, observer);
    Expected<void> watched;
    if (source.num_frames() > 0) {
        watch_recording(source, static_cast<std::size_t>(options.capture.every), watcher, stop);
    } else {
        watched = watch_live(source, options.capture, watcher, stop);
    }
    watcher.end();
    return watched;
}

}  // namespace atrium::calibrate
