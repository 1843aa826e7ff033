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
    double wait_s = 3.0;   // time to listen before the report of `once` [s]
    double seconds = 0.0;  // run time [s]; 0: until the stop
    std::string sites;     // sites whose cameras are always shown, separated by commas
    bool measure = false;
};

void declare(MonitorConfig& config, config::OptionSet& options);

/// Prints one report per second to standard output until the stop or the end of the time. With
/// `once` prints one report; error kNotFound if the world is empty then.
Expected<void> run_monitor(const MonitorConfig& config, std::stop_token stop);

}  // namespace atrium::monitor
