#pragma once

#include "core/base/latest_slot.hpp"
#include "core/bus/status_messages.hpp"
#include "site_node/coherence/coherence_watch.hpp"
#include "site_node/kept_silhouettes.hpp"
#include "site_node/views/named_view.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace atrium::site_node {

/// Watches whether the cameras of a running site are still where its rig says, in a thread of the
/// lowest priority: logs which one was moved or is late, and has the newest judgement for the
/// status. Costs the stages of the pipeline copies of the contours of two metaframes in a row,
/// twice a second.
class CoherenceWatcher {
public:
    using Clock = std::chrono::steady_clock;

    /// `rig_name`: for the command that mends it, which reads the silhouettes that the watcher
    /// writes into `kept_folder` while a camera's fault holds (KeptSilhouettes). Fewer than three
    /// cameras are not watched. `is_explained`: true while a mistake is known that explains all
    /// contradictions, which are not judged then. Any thread.
    CoherenceWatcher(
        std::vector<geometry::CalibratedCamera> cameras,
        double rate_hz,
        std::string rig_name,
        std::filesystem::path kept_folder = {},
        std::function<bool()> is_explained = [] { return false; });
    ~CoherenceWatcher();

    /// True if it wants the contours of metaframe `frame_id`: never before it is done with the
    /// last. One caller.
    bool wants(std::uint64_t frame_id, Clock::time_point now);
    /// Hands over what it wants, of the cameras that delivered.
    void put(std::uint64_t frame_id, std::vector<views::NamedView> views);

    /// True while it looks at what was put last. Any thread.
    bool is_looking() const { return is_looking_; }
    /// The newest judgement, with the fault that holds. Any thread.
    bus::RigCoherence newest() const;

    /// Ends the thread and logs the summary. Later calls do nothing.
    void finish();
    /// True if the silhouettes showed at last that the rig is not true. Call `finish` before.
    bool doubts_rig() const { return doubts_rig_; }

private:
    struct Look {
        KeptSilhouettes::Instant instant;
        Clock::time_point wanted_at;
    };
    void run(std::stop_token stop);
    void look(Look&& look);
    void keep(const coherence::CoherenceWatch::Judgement& judgement, Clock::time_point now);
    std::string refine_command(const std::string& options) const;
    std::vector<coherence::SilhouetteHull> hulls_of(
        const std::vector<views::NamedView>& views) const;
    void tell(const coherence::CoherenceWatch::Judgement& judgement) const;
    std::string text_of(const coherence::Report& report) const;
    std::string options_of(const coherence::Report& report) const;
    bus::RigCoherence status_of(const coherence::Report& report) const;
    std::string cure_of(const coherence::Report& report) const;

    const std::vector<geometry::CalibratedCamera> cameras_;
    const double rate_hz_;
    const std::string rig_name_;
    const std::function<bool()> is_explained_;
    // of the caller
    Clock::time_point due_{};
    std::optional<std::uint64_t> before_id_;
    std::vector<views::NamedView> before_;
    Clock::time_point wanted_at_{};
    // of the thread, and after its end of `finish`
    coherence::CoherenceWatch watch_;
    KeptSilhouettes kept_;
    std::optional<Clock::time_point> kept_at_;  // written, of the fault that holds
    bool is_kept_ = false;                      // the last writing succeeded
    bool doubts_rig_ = false;
    double cpu_s_ = 0.0;
    LatestSlot<Look> slot_;
    std::atomic<bool> is_looking_ = false;  // at what was put last
    mutable std::mutex newest_mutex_;
    bus::RigCoherence newest_;
    std::jthread thread_;  // last: uses the members above
};

}  // namespace atrium::site_node
