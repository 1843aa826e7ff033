#pragma once

#include "core/status/figures.hpp"
#include "viewer/people_view.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What sites and worlds report of themselves, as lines for people to read. Reports come once a
/// second; who has not reported for a while is forgotten.
class StatusLines {
public:
    using Clock = std::chrono::steady_clock;

    void add(const std::string& name, const bus::SiteStatus& status, Clock::time_point now) {
        add("site " + name, status::figures_of(status), now);
    }
    void add(const std::string& name, const bus::WorldStatus& status, Clock::time_point now) {
        add("world " + name, status::figures_of(status), now);
        last_world_ = now;
    }
    /// Of the viewer itself.
    void add_own(const bus::ViewerStatus& status, Clock::time_point now) {
        add("this viewer", status::figures_of(status), now);
    }
    /// After all that came: forgets who fell silent. Says in the log when the last world does, and
    /// when one is back.
    void forget_silent(Clock::time_point now);

    /// One for each who lost something from its report before to its last one, and one where there
    /// is no world any more.
    std::vector<SiteLine> warnings() const;
    /// For each, how fast it is, and how long each of its stages takes.
    std::vector<SiteLine> details() const;
    /// Whether a world server reports.
    bool has_world() const;
    /// Commands that worlds have refused so far, of whoever sent them.
    std::uint64_t num_refused() const;

private:
    struct Program {
        std::optional<status::Figures> before;  // of the same process
        status::Figures now;
        Clock::time_point at;
    };
    void add(const std::string& title, status::Figures figures, Clock::time_point now);

    std::map<std::string, Program> programs_;      // by kind and name
    std::optional<Clock::time_point> last_world_;  // last report of any
    Clock::duration without_world_{};              // 0 while there is one, and before there was any
};

}  // namespace atrium::viewer
