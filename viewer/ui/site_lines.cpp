#include "viewer/ui/site_lines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr std::size_t kMaxSiteLines = 64;

}  // namespace

std::vector<SiteLine> site_lines(const std::map<std::string, PeopleView::Stream>& streams,
                                 const std::set<std::string>& described,
                                 const StatusLines& reports) {
    std::set<std::string> names = described;
    for (const auto& [name, stream] : streams) names.insert(name);
    std::vector<SiteLine> lines;
    std::size_t number = 0;
    for (const std::string& name : names) {
        if (lines.size() >= kMaxSiteLines) break;
        SiteLine line;
        line.name = name;
        const auto published = reports.rate_of_site(name);
        const std::string of_site = published ? fmt::format(" of {:.0f}/s", *published) : "";
        const auto found = streams.find(name);
        if (found == streams.end()) {
            line.rate = published ? fmt::format("{:.0f}/s", *published) : "-";
            line.state = published ? "nobody there" : "no report";
            line.is_warning = !published;
        } else {
            line.number = ++number;
            line.rate = fmt::format("{:.0f}{}", found->second.per_s, published ? of_site : "/s");
            line.is_warning = found->second.silent_s > 0.0;
            line.state = line.is_warning
                             ? fmt::format("nothing new for {:.1f} s", found->second.silent_s)
                             : "live";
        }
        lines.push_back(std::move(line));
    }
    return lines;
}

std::string DepartedPeople::update(const std::vector<SiteLine>& lines, Clock::time_point now) {
    std::set<std::string> present;
    for (const SiteLine& line : lines) {
        if (line.number > 0) present.insert(line.name);
    }
    for (const std::string& name : present_) {
        if (!present.contains(name)) left_[name] = now;
    }
    present_ = std::move(present);
    std::erase_if(left_, [&](const auto& item) {
        return present_.contains(item.first) || now - item.second > kShown;
    });
    std::vector<std::string> texts;
    for (const auto& [name, since] : left_) {
        const auto ago_s = std::chrono::duration_cast<std::chrono::seconds>(now - since).count();
        texts.push_back(ago_s == 0 ? fmt::format("{} just left", name)
                                   : fmt::format("{} left {} s ago", name, ago_s));
    }
    return fmt::format("{}", fmt::join(texts, ", "));
}

void mark_selected(const SiteSelection& selection, std::vector<SiteLine>& lines) {
    for (SiteLine& line : lines) {
        line.is_shown = selection.shows(line.name);
        line.is_solo = selection.solo() == line.name;
    }
}

}  // namespace atrium::viewer
