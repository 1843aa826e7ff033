#pragma once

#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"

namespace atrium::bus {

/// Declares the bus options that all programs share: `bus.world`, `bus.domain`, `bus.network`,
/// `bus.peers`, `bus.interface`, `bus.profiles_file`.
void declare(BusOptions& options, config::OptionSet& set);

}  // namespace atrium::bus
