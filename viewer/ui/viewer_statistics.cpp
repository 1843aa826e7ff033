#include "viewer/ui/viewer_statistics.hpp"

#include "core/app/log.hpp"
#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/status/figures.hpp"
#include "viewer/ui/site_lines.hpp"

namespace atrium::viewer {
namespace {

constexpr std::chrono::seconds kLatencyShown{2};

}  // namespace

void ViewerStatistics::add_picture(const std::vector<PeopleView::JustShown>& people,
                                   Clock::time_point now) {
    const Timestamp displayed = Timestamp::now();
    const Clock::time_point shown_at = Clock::now();
    pictures_.add(1.0, now);
    for (const PeopleView::JustShown& shown : people) {
        latency_.add(displayed - shown.delays_from);
        shown_at_ = now;
        latencies_ms_.add(milliseconds(displayed - shown.delays_from), now);
        times_.add_way(shown.ready - shown.complete, now - shown.ready, shown_at - shown.complete);
    }
    if (num_pictures_ == 0) first_output_s_ = app::seconds_since_start();
    ++num_pictures_;
}

void ViewerStatistics::update(Clock::time_point now,
                              Session& session,
                              PeopleView& people,
                              const std::set<std::string>& described,
                              const PictureQuality& quality,
                              HudContent& hud) {
    const Quantiles quantiles = latency_.quantiles();
    const bus::LatencySummary latency{quantiles.median_ms, quantiles.p99_ms, quantiles.num_samples};
    // an old latency says nothing about people who no longer come
    hud.capture_to_display =
        shown_at_ && now - *shown_at_ <= kLatencyShown ? latency : bus::LatencySummary{};
    hud.frames_per_s = rate_.update(num_pictures_, now);
    hud.bytes_per_s = byte_rate_.update(session.num_bytes(), now);
    hud.num_skipped = session.num_pairs_skipped();
    hud.num_incomplete = session.num_incomplete();
    hud.num_rejected = session.num_rejected();
    hud.latency_ms = latencies_ms_.values(History::Of::kMean, now);
    hud.pictures_per_s = pictures_.values(History::Of::kPerSecond, now);
    bus::ViewerStatus next;
    next.viewer = viewer_;
    next.time = Timestamp::now();
    next.num_frames = num_pictures_;
    next.num_pairs_shown = people.num_pairs_shown();
    next.num_pairs_skipped = hud.num_skipped;
    next.num_incomplete = hud.num_incomplete;
    next.num_rejected = hud.num_rejected;
    next.frames_per_s = hud.frames_per_s;
    next.capture_to_display = latency;
    next.resident_bytes = app::resident_bytes();
    next.processor = processor_meter_.update(now);
    next.first_output_s = first_output_s_;
    next.max_frames_per_s = quality.max_fps;
    next.scale = quality.scale;
    next.has_shadows = quality.has_shadows;
    next.num_video_dropped = hud.num_video_dropped;
    const StatusReports came = session.take_statuses();
    for (const auto& [site, report] : came.sites) reports_.add(site, report, now);
    for (const auto& [world, report] : came.worlds) reports_.add(world, report, now);
    reports_.add_own(next, now);
    reports_.forget_silent(now);
    reports_.set_other_worlds(hud.other_worlds);
    if (!hud.timeline) watch_world(now, session, hud);
    hud.sites = site_lines(people.streams(now), described, reports_);
    hud.warnings = reports_.warnings();
    hud.details = reports_.details();
    if (const auto line = overload_.look(status::figures_of(next), now))
        app::log::warn("{}", *line);
    const std::lock_guard lock(status_mutex_);
    status_ = next;
}

bus::ViewerStatus ViewerStatistics::status() const {
    const std::lock_guard lock(status_mutex_);
    return status_;
}

void ViewerStatistics::log_stopped(double frames_per_s, std::uint64_t num_deadlines_missed) const {
    const bus::ViewerStatus last = status();
    app::log::info(
        "viewer_stopped frames={} frames_per_s={:.1f} pairs_shown={} pairs_skipped={} "
        "incomplete={} rejected={} capture_to_display_ms={:.1f} p99_ms={:.1f} "
        "{} deadlines_missed={} {}",
        last.num_frames,
        frames_per_s,
        last.num_pairs_shown,
        last.num_pairs_skipped,
        last.num_incomplete,
        last.num_rejected,
        last.capture_to_display.median_ms,
        last.capture_to_display.p99_ms,
        times_.text(),
        num_deadlines_missed,
        status::process_fields(last.processor, last.first_output_s));
}

}  // namespace atrium::viewer
