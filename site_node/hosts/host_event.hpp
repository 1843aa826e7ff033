#pragma once

#include <string>

namespace atrium::hosts {

/// A line for the log: a host comes or goes, and why.
struct HostEvent {
    bool is_warning = false;
    std::string line;
};

}  // namespace atrium::hosts
