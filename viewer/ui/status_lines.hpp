#pragma once

#include "core/bus/bus.hpp"
#include "core/status/figures.hpp"
#include "viewer/scene/people_view.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// Formats the status reports of sites and worlds as HUD lines. Reports come once a second; a
/// silent program is forgotten after a few seconds.
class StatusLines {
public:
    using Clock = std::chrono::steady_clock;

    void add(const std::string& name, const bus::SiteStatus& status, Clock::time_point now) {
        add("site " + name, status::figures_of(status), now);
    }
    void add(const std::string& name, const bus::WorldStatus& status, Clock::time_point now) {
        add("world " + name, status::figures_of(status), now);
    }
    /// Adds the viewer's own status.
    void add_own(const bus::ViewerStatus& status, Clock::time_point now) {
        add("this viewer", status::figures_of(status), now);
    }
    /// Call after all `add`. Forgets silent programs.
    void forget_silent(Clock::time_point now);
    /// `heard`: when a world server was last heard, by any of its topics. Logs when the last world
    /// goes silent and when one is back. Returns whether that changed. Cheap: call it for each
    /// picture.
    ///
    /// `lost`: when objects of a world server were found without a writer. If nothing was heard
    /// since, the world server is gone before its silence says so.
    bool watch_world(Clock::time_point now,
                     const std::optional<Clock::time_point>& heard = {},
                     const std::optional<Clock::time_point>& lost = {});
    /// Worlds that may be meant instead of this one, for the warning that it has no server.
    void set_other_worlds(bus::OtherWorlds worlds) { other_worlds_ = std::move(worlds); }

    /// One line while no world reports, one per alarm, one for each program that lost something
    /// between its last two reports, and one per bottleneck.
    std::vector<HudLine> warnings() const;
    /// Rate and stage times of each program; of a site how true its rig is, and what mends it.
    std::vector<HudLine> details() const;
    /// Whether a world server is heard.
    bool has_world() const { return last_world_ && without_world_ == Clock::duration::zero(); }
    /// Metaframes per second that the site reports. Empty: no report.
    std::optional<double> rate_of_site(const std::string& site) const;
    /// Commands of any sender that worlds have refused so far.
    std::uint64_t num_refused() const;

private:
    struct Program {
        std::optional<status::Figures> before;  // same process
        status::Figures now;
        Clock::time_point at;
    };
    void add(const std::string& title, status::Figures figures, Clock::time_point now);

    std::map<std::string, Program> programs_;      // key: kind and name
    std::optional<Clock::time_point> last_world_;  // any world was heard
    Clock::duration without_world_{};              // 0 while there is a world, and before the first
    std::optional<Clock::time_point> watched_since_;
    bool is_world_missing_ = false;  // none was ever heard
    bus::OtherWorlds other_worlds_;
};

}  // namespace atrium::viewer
