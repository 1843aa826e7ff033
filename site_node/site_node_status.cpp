#include "core/app/program.hpp"
#include "core/app/progress.hpp"
#include "core/base/next_second.hpp"
#include "core/status/bottleneck.hpp"
#include "site_node/metaframe_losses.hpp"
#include "site_node/overload_advice.hpp"
#include "site_node/site_node.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

// Status of a site, published once a second.
namespace atrium::site_node {
namespace {

constexpr auto kRefinementPaused =
    "the hull is not refined, the host is too slow: set capture.rate_hz lower, or hull.refine = "
    "off";

}  // namespace

void SiteNode::report_status(std::stop_token stop) {
    using Clock = std::chrono::steady_clock;
    std::mutex mutex;
    std::condition_variable_any wake;
    const auto begin = Clock::now();
    bus::SiteStatus former;
    const double asked_hz = metaframe_rate_hz(config_, source_->rig());
    std::optional<StageTimes::Work> largest_work;
    atrium::status::OverloadLog overload(
        bus::ProgramKind::kSiteNode, [&](atrium::status::Cause cause) {
            return overload_advice({asked_hz,
                                    metaframes_per_s_,
                                    former.processor.run_per_s,
                                    config_.threads,
                                    static_cast<int>(std::thread::hardware_concurrency()),
                                    largest_work},
                                   cause);
        });
    std::vector<capture::CameraCounters> former_cameras = source_->camera_counters();
    app::Progress progress("frame", source_->num_frames(), std::chrono::seconds(10));
    const bool has_end = source_->num_frames() > 0 && !config_.capture.loop;
    while (!stop.stop_requested()) {
        auto until = next_second(begin, Clock::now());
        const bool limited = config_.seconds > 0.0;
        const auto end = begin + std::chrono::duration_cast<Clock::duration>(
                                     std::chrono::duration<double>(config_.seconds));
        if (limited) until = std::min(until, end);
        std::unique_lock lock(mutex);
        wake.wait_until(lock, stop, until, [] { return false; });
        if (limited && Clock::now() >= end) run_control_->finish({});
        metaframes_per_s_ = published_rate_.update(num_published_, Clock::now());
        bytes_per_s_ = bytes_rate_.update(num_bytes_, Clock::now());
        stage_times_.update_rates(Clock::now());
        bus::SiteStatus now = status();
        now.processor = processor_meter_.update();  // after the losses, see bottlenecks()
        {
            const std::lock_guard processor_lock(processor_mutex_);
            processor_ = now.processor;
        }
        if (auto written = writers_.status.write(now); !written)
            complaints_.warn(written.error().message);
        if (const std::string line = losses_line(former, now); !line.empty())
            app::log::debug("this second {}", line);
        if (auto* const worker = pipeline_.worker()) {
            worker->look(Clock::now());
            app::log::debug("segmentation_worker {}", worker->line());
        }
        former = now;
        largest_work = stage_times_.largest_work();
        look_at_refinement(now);
        if (const auto line = overload.look(atrium::status::figures_of(now), Clock::now()))
            app::log::warn("{}", *line);
        const auto cameras = source_->camera_counters();
        for (std::size_t i = 0; i < cameras.size() && source_->is_live(); ++i) {
            app::log::debug("this second camera {}", to_line(since(former_cameras[i], cameras[i])));
        }
        former_cameras = cameras;
        if (!has_end) continue;
        if (const auto line = progress.update(source_->num_passed()))
            app::log::info("playing {}", *line);
    }
}

// Whole metaframes are worth more than refined ones. A recording that is played as fast as possible
// drops none.
void SiteNode::look_at_refinement(const bus::SiteStatus& now) {
    if (!pipeline_.refines_by_pictures() || !config_.pipeline.hull.pause_refinement) return;
    const auto time = RefinementPause::Clock::now();
    if (!refinement_pause_.look(time, now.num_metaframes_captured, metaframes_.num_dropped()))
        return;
    is_refinement_paused_ = refinement_pause_.is_paused();
    if (is_refinement_paused_)
        app::log::warn("refinement_paused seconds={} reason=\"{}\"",
                       refinement_pause_.duration().count(),
                       kRefinementPaused);
    else
        app::log::info("refinement_resumed");
}

bus::SiteStatus SiteNode::status() const {
    bus::SiteStatus status;
    status.site = config_.name;
    status.time = Timestamp::now();
    status.num_metaframes_captured = num_captured_;
    status.num_metaframes_published = num_published_;
    status.num_incomplete_used = num_incomplete_used_;
    status.num_dropped_incomplete = num_incomplete_;
    status.num_dropped_late = metaframes_.num_dropped() + site_frames_.num_dropped();
    status.num_failed = num_failed_;
    {
        const std::lock_guard lock(losses_mutex_);
        status.left_out = losses_;
    }
    status.num_bytes_published = num_bytes_;
    status.metaframes_per_s = metaframes_per_s_;
    status.bytes_per_s = bytes_per_s_;
    status.resident_bytes = app::resident_bytes();
    status.cameras = camera_statuses(source_->camera_counters(), offsets_);
    status.stream = stream_.state();
    stage_times_.put_into(status);
    status.first_output_s = first_output_s_;
    status.coherence = coherence_watcher_.newest();
    status.finding = rig_watcher_.finding();
    if (const auto* const worker = pipeline_.worker(); worker != nullptr && status.finding.empty())
        status.finding = worker->finding();
    if (is_refinement_paused_ && status.finding.empty()) status.finding = kRefinementPaused;
    if (hosts_ != nullptr) status.hosts = hosts_->statuses();
    if (region_hosts_ != nullptr) {
        const auto regions = region_hosts_->statuses();
        status.hosts.insert(status.hosts.end(), regions.begin(), regions.end());
    }
    const std::lock_guard lock(processor_mutex_);
    status.processor = processor_;
    return status;
}

}  // namespace atrium::site_node
