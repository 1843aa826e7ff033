#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/placement.hpp"

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace atrium::world_server {

/// The sites that are there, and where they stand. Not thread-safe; no network.
class SiteRegister {
public:
    SiteRegister(const std::vector<NamedPlacement>& named, std::size_t max_sites)
        : placer_(named, max_sites) {}

    /// The site is there. Returns its placement when it was not there before. Fails with
    /// kUnavailable when the world has its largest number of sites.
    Expected<std::optional<bus::SitePlacement>> arrive(const std::string& site);
    bool leave(const std::string& site);  // false: it was not there

    std::size_t num_present() const { return sites_.size(); }

private:
    SitePlacer placer_;
    std::set<std::string> sites_;
};

}  // namespace atrium::world_server
