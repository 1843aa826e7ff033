#pragma once

#include "core/base/latest_slot.hpp"
#include "site_node/rig_check/rig_watch.hpp"

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <thread>

namespace atrium::site_node {

/// Judges the rig of a running site in a thread of the lowest priority, and logs what it finds.
/// Costs the stages of the pipeline one copy of a metaframe's contours and mesh per look: one per
/// second, and one in five seconds while all is well.
class RigWatcher {
public:
    using Clock = std::chrono::steady_clock;

    explicit RigWatcher(rig_check::AgreementOptions options);
    ~RigWatcher();

    /// True if the next look is due. One caller.
    bool wants_look(Clock::time_point now);
    /// Hands over what it wants; newest wins.
    void put(rig_check::Look look) { slot_.put(std::move(look)); }

    /// What is wrong with the rig or the pictures, as a line of a status; empty without a finding
    /// that holds. Any thread.
    std::string finding() const;
    /// True while a mistake holds that explains the silhouettes (RigWatch). Any thread.
    bool is_explained() const { return is_explained_; }

    /// Ends the thread, judges the last look, and logs the summary. Later calls do nothing.
    /// `is_rig_in_doubt`: for other reasons than its own.
    void finish(bool is_rig_in_doubt = false);
    /// The reason of the last finding that was logged; empty without any. Call `finish` before.
    const std::string& last_reason() const { return watch_.last_reason(); }

private:
    void run(std::stop_token stop);
    void judge(const rig_check::Look& look, const std::stop_token& stop);

    rig_check::RigWatch watch_;  // of the thread, and after its end of `finish`
    LatestSlot<rig_check::Look> slot_;
    Clock::time_point due_{};
    std::atomic<bool> is_well_ = false;  // the last looks found nothing to doubt
    std::atomic<bool> is_explained_ = false;
    mutable std::mutex finding_mutex_;
    std::string finding_;
    std::jthread thread_;  // last: uses the members above
};

}  // namespace atrium::site_node
