#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"

#include <cstdint>
#include <memory>

namespace atrium::test {

/// A host that exists only in the kernel: a user and a network namespace with `lo` and the TUN
/// device `link0`, whose other end is `tun`. It vanishes with its descriptors and its last process.
struct NetworkHost {
    std::unique_ptr<Descriptor> tun;  // non-blocking
    std::unique_ptr<Descriptor> user_namespace;
    std::unique_ptr<Descriptor> network_namespace;
    std::uint32_t address = 0;  // IPv4 of link0, host byte order
};

inline constexpr const char* kLinkName = "link0";

/// Addresses differ in the last byte only. Hosts with equal first three bytes reach each other
/// through `link0`, by unicast and multicast. MTU 1500. Needs no rights and does not move this
/// process. Error kUnavailable if namespaces or /dev/net/tun are not permitted, with the missing
/// permission.
Expected<NetworkHost> make_network_host(std::uint32_t address);

/// Moves the calling process into the host. For a child between fork and exec, which must have one
/// thread. Makes only calls that are safe there. Returns false if the kernel refuses.
bool enter(const NetworkHost& host);

/// A UDP socket in the host, bound to its address and `port`, whichever process uses it. Each
/// packet carries the time at which the host's kernel received it (SO_TIMESTAMPNS).
Expected<std::unique_ptr<Descriptor>> open_udp_socket(const NetworkHost& host, std::uint16_t port);

}  // namespace atrium::test
