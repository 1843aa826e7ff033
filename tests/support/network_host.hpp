#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"

#include <cstdint>
#include <memory>

namespace atrium::test {

/// A host that is only a name to the kernel: a user and a network namespace with nothing in it but
/// `lo` and the TUN device `link0`, whose other end is `tun`. Gone with its descriptors and the
/// last process in it.
struct NetworkHost {
    std::unique_ptr<Descriptor> tun;  // does not block
    std::unique_ptr<Descriptor> user_namespace;
    std::unique_ptr<Descriptor> network_namespace;
    std::uint32_t address = 0;  // IPv4, host byte order; of link0
};

inline constexpr const char* kLinkName = "link0";

/// Addresses differ in the last byte only: hosts with the same three bytes before reach each other
/// through `link0`, as does multicast. MTU 1500. Needs no rights; leaves this process where it is.
/// Error kUnavailable where namespaces or /dev/net/tun are not permitted, with what would be.
Expected<NetworkHost> make_network_host(std::uint32_t address);

/// Moves the calling process into the host; for a child between fork and exec: it must have one
/// thread, and only calls that are safe there are made. False where the kernel refuses.
bool enter(const NetworkHost& host);

/// A UDP socket that lives in the host, bound to its address and `port`, whatever process uses it.
/// Each packet carries the time at which the host's kernel took it (SO_TIMESTAMPNS).
Expected<std::unique_ptr<Descriptor>> open_udp_socket(const NetworkHost& host, std::uint16_t port);

}  // namespace atrium::test
