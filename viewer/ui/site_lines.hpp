#pragma once

#include "viewer/control/site_selection.hpp"
#include "viewer/scene/people_view.hpp"
#include "viewer/ui/status_lines.hpp"
#include "viewer/ui/surface.hpp"

#include <chrono>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Lists the sites that have a person, a description or a status report. `described`: sites that
/// published a description. At most 64 lines.
std::vector<SiteLine> site_lines(const std::map<std::string, PeopleView::Stream>& streams,
                                 const std::set<std::string>& described,
                                 const StatusLines& reports);

/// Remembers for a while who has left.
class DepartedPeople {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds kShown{20};

    /// Returns who has left and is not back: "bob left 3 s ago". Empty: nobody.
    std::string update(const std::vector<SiteLine>& lines, Clock::time_point now);

private:
    std::set<std::string> present_;
    std::map<std::string, Clock::time_point> left_;
};

/// Marks what the user hides.
void mark_selected(const SiteSelection& selection, std::vector<SiteLine>& lines);

}  // namespace atrium::viewer
