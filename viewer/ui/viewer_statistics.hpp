#pragma once

#include "core/base/processor_use.hpp"
#include "core/base/statistics.hpp"
#include "core/bus/messages.hpp"
#include "core/status/bottleneck.hpp"
#include "viewer/pacing/adaptive_quality.hpp"
#include "viewer/pacing/drawing_times.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/scene/people_view.hpp"
#include "viewer/ui/history.hpp"
#include "viewer/ui/status_lines.hpp"
#include "viewer/ui/surface.hpp"

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// Measures pictures and data, for the HUD, the status and the log. Drawing thread only, except
/// `status`.
class ViewerStatistics {
public:
    using Clock = std::chrono::steady_clock;

    explicit ViewerStatistics(std::string viewer) : viewer_(std::move(viewer)) {}

    /// Adds a picture that was just displayed, with the people who are new in it. `now`: when its
    /// people were taken.
    void add_picture(const std::vector<PeopleView::JustShown>& people, Clock::time_point now);
    std::uint64_t num_pictures() const { return num_pictures_; }
    DrawingTimes& times() { return times_; }

    /// Brings status, status reports of others and the figures of `hud` up to date. Logs an
    /// overload. Takes `hud.num_video_dropped`. `described`: sites with a description.
    void update(Clock::time_point now,
                Session& session,
                PeopleView& people,
                const std::set<std::string>& described,
                const PictureQuality& quality,
                HudContent& hud);
    /// Warns in `hud` at once when the world server is lost, or back. Call it for each picture.
    void watch_world(Clock::time_point now, const Session& session, HudContent& hud) {
        if (reports_.watch_world(now, session.world_heard(), session.world_lost()))
            hud.warnings = reports_.warnings();
    }
    /// Status at the last `update`. Any thread.
    bus::ViewerStatus status() const;
    /// Answers of the world servers, for SceneEditor.
    SceneEditor::Servers servers() const { return {reports_.has_world(), reports_.num_refused()}; }
    /// Logs the figures of the run. Call after `update`.
    void log_stopped(double frames_per_s, std::uint64_t num_deadlines_missed) const;

private:
    std::string viewer_;
    StatusLines reports_;
    status::OverloadLog overload_{bus::ProgramKind::kViewer};
    LatencyWindow latency_;
    std::optional<Clock::time_point> shown_at_;  // the last new person
    DrawingTimes times_;
    RateMeter rate_;
    RateMeter byte_rate_;
    History latencies_ms_;  // one value per new person
    History pictures_;
    std::uint64_t num_pictures_ = 0;
    double first_output_s_ = 0.0;  // 0: no picture yet
    ProcessorMeter processor_meter_;
    mutable std::mutex status_mutex_;
    bus::ViewerStatus status_;  // guarded by status_mutex_
};

}  // namespace atrium::viewer
