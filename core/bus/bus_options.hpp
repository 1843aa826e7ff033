#pragma once

#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"

namespace atrium::bus {

/// Declares the bus options that all programs share: `bus.world`, `bus.domain`, `bus.network`,
/// `bus.peers`, `bus.interface`, `bus.profiles_file`, `bus.security`, `bus.join`.
void declare(BusOptions& options, config::OptionSet& set);

/// Without `options.keys`, reads the bundle that `options.security` names; if that is empty, the
/// environment variable ATRIUM_SECURITY; else `bundle` among the credentials of systemd. Checks it,
/// sets `options.keys`, and `options.world` to its world. With `options.join` also sets network,
/// interface and peers to those of its tunnel. Does nothing if there is no bundle. Fails as
/// keys::read_bundle and keys::check do, with kConfiguration if `options.world` is set to another
/// world, there is no tunnel in the file or the variable is set and empty, with kUnavailable if the
/// tunnel is not up. Errors begin with the option or variable that names the bundle.
Expected<void> enter_keys(BusOptions& options);

/// As `enter_keys` for a program whose keys must be of `kind`, and with its name: an empty one
/// becomes that of the keys; another one is kConfiguration.
Expected<void> enter_keys(BusOptions& options, keys::Kind kind, std::string& name);

}  // namespace atrium::bus
