#pragma once

#include "core/base/expected.hpp"
#include "core/base/run_command.hpp"
#include "core/base/timestamp.hpp"
#include "core/keys/tunnel.hpp"

#include <functional>
#include <string>
#include <vector>

/// Brings up the WireGuard tunnel of a bundle on this host, with `ip` and `wg`, and
/// `wireguard-go` where the kernel has no WireGuard.
namespace atrium::tunnel_tool {

/// Runs programs: run_command, or a stand-in in tests.
using Run = std::function<std::optional<CommandOutput>(const std::vector<std::string>& command,
                                                       std::string_view input)>;

/// What packets in the tunnel may be: WireGuard adds up to 80 bytes, and networks carry 1500.
inline constexpr int kTunnelMtu = 1420;
/// Number of the table of routes of a hub, for packets that come out of this card: of two hubs on
/// one host each has its own.
int hub_table(const std::string& card);

/// Makes the card `card` if it is missing and configures it. If it is up already, only what has
/// changed: connections go on. At the hub packets between spokes are passed on, and none from the
/// tunnel to other networks. Fails with kUnavailable and the cure: without the right to change the
/// network, without the programs, or if the card is up for another place.
Expected<void> bring_up(const keys::Tunnel& tunnel, const std::string& card, const Run& run);

/// Removes the card and the routes. Nothing happens if there is none.
Expected<void> take_down(const keys::Tunnel& tunnel, const std::string& card, const Run& run);

/// A table: each place with its address, when it was heard last, and bytes. kUnavailable if the
/// tunnel is not up.
Expected<std::string> describe(const keys::Tunnel& tunnel,
                               const std::string& card,
                               Timestamp now,
                               const Run& run);

/// Runs a command and returns its output. kUnavailable if it fails, with what it said.
Expected<std::string> run_or_fail(const Run& run,
                                  const std::vector<std::string>& command,
                                  std::string_view input = {});

}  // namespace atrium::tunnel_tool
