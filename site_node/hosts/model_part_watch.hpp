#pragma once

#include "site_node/hosts/host_event.hpp"
#include "site_node/hosts/site_hosts.hpp"

#include <chrono>
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

    /// `is_heard`: since the last look. Returns a line for the log: once when it is there, once
    /// when it was not heard for `kPatience`.
    std::optional<HostEvent> look(bool is_heard, Time now);

private:
    std::string host_;  // of the model part
    Time last_;         // when it was heard last
    bool is_there_ = false;
    bool told_missing_ = false;
};

}  // namespace atrium::hosts
