#pragma once

#include "world_server/physics/person_shape.hpp"

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace atrium::world_server {

/// The newest news of each site, from the thread that receives to the one that simulates: newest
/// wins, per site. Thread-safe; holds one shape per site.
class PeopleInbox {
public:
    /// `shape`: nullopt when nobody is in the site.
    void put(const std::string& site, std::optional<physics::PersonShape> shape);

    /// Calls `visit` for each site of which something is new. Never waits for long.
    void take_all(const std::function<void(const std::string& site,
                                           std::optional<physics::PersonShape>&& shape)>& visit);

private:
    std::mutex mutex_;
    std::map<std::string, std::optional<physics::PersonShape>> news_;
};

}  // namespace atrium::world_server
