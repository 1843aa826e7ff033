#include "world_server/site_register.hpp"

#include <fmt/format.h>

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

}  // namespace atrium::world_server
