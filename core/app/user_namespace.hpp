#pragma once

#include "core/base/expected.hpp"

namespace atrium::app {

/// Moves this process into a user and a network namespace of its own, without any right: it sees
/// no network but a loopback interface of its own, and so do the processes that it starts. Inside
/// it is root, which lets it set that interface up and open packet sockets; outside it stays who it
/// was. Must be called before any thread is started, and cannot be undone.
///
/// Error kUnavailable where the kernel does not permit it, naming the setting that would.
Expected<void> enter_own_network();

/// Brings the loopback interface of this network namespace up and gives it 127.0.0.1 to
/// 127.0.0.`num_addresses` (1 to 254), each as an address of its own, which programs can find by
/// listing interfaces. Addresses that are there already stay. Error kUnavailable.
Expected<void> bring_up_loopback(int num_addresses);

}  // namespace atrium::app
