#pragma once

#include "viewer/control/site_selection.hpp"
#include "viewer/scene/people_view.hpp"
#include "viewer/ui/status_lines.hpp"
#include "viewer/ui/surface.hpp"

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

/// Tells the user who is no longer among the lines: "bob left". Empty: nobody.
std::string text_of_left(const std::vector<SiteLine>& before, const std::vector<SiteLine>& now);

/// Marks what the user hides.
void mark_selected(const SiteSelection& selection, std::vector<SiteLine>& lines);

}  // namespace atrium::viewer
