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

/// Registers the sites that are present, with their places. No network. Not thread-safe.
class SiteRegister {
public:
    SiteRegister(const std::vector<NamedPlacement>& named, std::size_t max_sites)
        : placer_(named, max_sites) {
        for (const NamedPlacement& placement : named) named_.push_back(placement.site);
    }

    /// Registers a site. Returns its placement if it was not present before. Fails with
    /// kUnavailable if the world is full.
    Expected<std::optional<bus::SitePlacement>> arrive(const std::string& site);
    bool leave(const std::string& site);  // false if it was not present
    /// For a site that the world file does not name: "did you mean Alice?" with the names of absent
    /// ones that are spelt alike, or nothing.
    std::string ask_meant(const std::string& site) const;

    std::size_t num_present() const { return sites_.size(); }

private:
    SitePlacer placer_;
    std::vector<std::string> named_;  // in the world file
    std::set<std::string> sites_;
};

}  // namespace atrium::world_server
