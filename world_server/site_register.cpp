#include "world_server/site_register.hpp"

#include "core/config/spelling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace atrium::world_server {

Expected<std::optional<bus::SitePlacement>> SiteRegister::arrive(const std::string& site) {
    if (sites_.contains(site)) return std::nullopt;
    const auto place = placer_.place(site);
    if (!place) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("site {}: the world is full (world.max_sites)", site));
    }
    sites_.insert(site);
    return bus::SitePlacement{site, *place};
}

bool SiteRegister::leave(const std::string& site) { return sites_.erase(site) > 0; }

std::string SiteRegister::ask_meant(const std::string& site) const {
    if (std::ranges::find(named_, site) != named_.end()) return {};
    const auto in_lower_case = [](std::string name) {
        for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        return name;
    };
    const std::string written = in_lower_case(site);
    std::vector<std::string> meant;
    for (const std::string& name : named_) {
        const bool is_alike = config::may_be_misspelling(written, in_lower_case(name));
        if (is_alike && !sites_.contains(name)) meant.push_back(name);
    }
    return config::ask_which(meant);
}

}  // namespace atrium::world_server
