#pragma once

#include "core/app/log.hpp"

#include <string>

namespace atrium::hosts {

/// A line for the log: a host comes or goes, and why.
struct HostEvent {
    bool is_warning = false;
    std::string line;
};

inline void log(const HostEvent& event) {
    app::log::write(event.is_warning ? app::log::Level::kWarn : app::log::Level::kInfo, event.line);
}

}  // namespace atrium::hosts
