#pragma once

#include "world_server/physics/people/person_shape.hpp"

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace atrium::world_server {

/// Hands the newest shape of each site from the receiving to the simulating thread. A newer shape
/// of a site replaces the older one. Holds one shape per site. Thread-safe.
class PeopleInbox {
public:
    /// `shape`: nullopt if the site has no person.
    void put(const std::string& site, std::optional<physics::PersonShape> shape);

    /// Calls `visit` for each site with news. Never waits for long.
    void take_all(const std::function<void(const std::string& site,
                                           std::optional<physics::PersonShape>&& shape)>& visit);

private:
    std::mutex mutex_;
    std::map<std::string, std::optional<physics::PersonShape>> news_;
};

}  // namespace atrium::world_server
