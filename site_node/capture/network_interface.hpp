#pragma once

#include <cstdint>
#include <string>

namespace atrium::capture {

/// The IPv4 address that packets to `address` leave from; empty where no interface leads there.
std::string own_address_towards(const std::string& address);

/// Largest IP packet of the interface with this address [bytes]; 1500 where it cannot be found out.
int mtu_of_interface(const std::string& own_address);

/// Most that a socket may buffer without further rights [bytes]; 0 where the system does not tell.
std::uint64_t max_socket_buffer_bytes();

/// True where packet sockets may be opened (cap_net_raw).
bool may_use_packet_sockets();

}  // namespace atrium::capture
