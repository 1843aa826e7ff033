#pragma once

#include "core/keys/tunnel.hpp"
#include "tools/tunnel/tunnel.hpp"

#include <filesystem>
#include <stop_token>
#include <string>

namespace atrium::tunnel_tool {

/// Keeps a spoke's way to the hub open until the card is gone or a stop is requested: looks once a
/// second with which address this host reaches the hub, and tells WireGuard the hub's address again
/// when that or the hub's has changed. wireguard-go goes on sending from an address that the host
/// has lost, and no WireGuard asks for the address of a name twice.
void keep(const keys::Tunnel& tunnel,
          const std::string& card,
          const Run& run,
          std::stop_token stop);

/// True if this host knows the hub's name.
bool knows_hub(const keys::Tunnel& tunnel);

/// Of several keepers of a card only the newest goes on: ends the other one, and holds the lock
/// file until the process ends. kUnavailable if that fails.
Expected<void> become_the_keeper(const std::string& card, const std::filesystem::path& folder);

}  // namespace atrium::tunnel_tool
