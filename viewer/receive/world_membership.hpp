#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/presence/membership.hpp"
#include "viewer/receive/empty_world_warning.hpp"

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Claims the viewer's name in a world and warns if nobody else is there.
class WorldMembership {
public:
    /// Joins as `viewer`, which takes most of a second. Errors: see presence::join_world.
    Expected<void> join(const bus::Participant& participant,
                        const std::string& viewer,
                        std::stop_token stop);
    /// Error if another program has got the name since. Any thread.
    Expected<void> check_name() const;
    /// As bus::Participant::place.
    std::string place() const { return membership_->place(); }
    /// As bus::Participant::other_worlds.
    bus::OtherWorlds other_worlds() const { return membership_->other_worlds(); }
    /// Names of the sites that are present, without those in `known`.
    std::vector<std::string> sites_other_than(const std::set<std::string>& known) const;
    /// Whether a world server or a site was there.
    bool has_met_others() const { return empty_world_.has_met_others(); }
    /// Updates the warning. `is_over`: the run ends.
    void warn_if_alone(std::chrono::steady_clock::time_point now, bool is_over) {
        empty_world_.update(membership_->present(), membership_->place(), now, is_over);
    }

private:
    EmptyWorldWarning empty_world_;
    mutable std::mutex mutex_;
    Expected<void> name_;  // guarded by mutex_
    /// Last: its thread uses the other members.
    std::unique_ptr<presence::Membership> membership_;
};

}  // namespace atrium::viewer
