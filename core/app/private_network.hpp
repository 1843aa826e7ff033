#pragma once

#include "core/base/expected.hpp"

namespace atrium::app {

/// Moves this process into a private user and network namespace; needs no privilege. The process
/// and its children see only a private loopback interface. Inside it is root: it may configure the
/// interface and open packet sockets. Outside it keeps its user. Call it before any thread starts;
/// it cannot be undone.
///
/// Fails with kUnavailable if the kernel does not permit it; the message names the setting to
/// change.
Expected<void> enter_private_network();

/// Brings up the loopback interface of this network namespace and adds the addresses 127.0.0.1 to
/// 127.0.0.`num_addresses` (1 to 254). Each is a separate address, listed by getifaddrs. Existing
/// addresses stay. Fails with kUnavailable.
Expected<void> bring_up_loopback(int num_addresses);

}  // namespace atrium::app
