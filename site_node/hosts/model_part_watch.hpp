#pragma once

#include "site_node/hosts/host_event.hpp"
#include "site_node/hosts/site_hosts.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace atrium::hosts {

/// Notices on another host of the site whether the model part is there. Not thread-safe.
class ModelPartWatch {
public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr std::chrono::seconds kPatience{5};

    ModelPartWatch(const std::vector<HostEntry>& hosts, Time start);

    /// `num_orders`: that came from the model part so far. Returns a line for the log: once when
    /// orders come, once when none came for `kPatience`.
    std::optional<HostEvent> look(std::uint64_t num_orders, Time now);

private:
    std::string host_;  // of the model part
    std::uint64_t num_orders_ = 0;
    Time last_;  // when orders came last
    bool is_there_ = false;
    bool told_missing_ = false;
};

}  // namespace atrium::hosts
