#pragma once

#include <cstdint>
#include <string>

namespace atrium::capture {

/// Returns the local IPv4 address from which packets to `address` leave; empty if there is no
/// route.
std::string own_address_towards(const std::string& address);

/// Returns the MTU of the interface with this address [bytes]; 1500 if it is unknown.
int mtu_of_interface(const std::string& own_address);

/// Returns the largest socket buffer without further privileges [bytes]; 0 if it is unknown.
std::uint64_t max_socket_buffer_bytes();

/// Returns true if this process may open packet sockets (cap_net_raw).
bool may_use_packet_sockets();

}  // namespace atrium::capture
