#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"

#include <stop_token>
#include <string>

namespace atrium::monitor {

struct MonitorConfig {
    bus::BusOptions bus;
    bool json = false;
    bool once = false;
    double wait_s = 3.0;   // before the report of `once`
    double seconds = 0.0;  // 0: until the stop
    std::string sites;     // whose cameras are shown in any case, separated by commas
    bool measure = false;
};

void declare(MonitorConfig& config, config::OptionSet& options);

/// Shows one report per second on standard output until the stop or the end of the time. With
/// `once` one report; kNotFound where nobody is there then.
Expected<void> run_monitor(const MonitorConfig& config, std::stop_token stop);

}  // namespace atrium::monitor
