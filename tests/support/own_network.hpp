#pragma once

#include <string>

namespace atrium::test_support {

/// Moves this test program into a user and a network namespace of its own, whose loopback interface
/// has the addresses 127.0.0.1 to 127.0.0.`num_addresses`. Where that is not permitted the program
/// stays where it is, and `reason_without_own_network` says why. First thing in main: before any
/// thread is started.
void enter_own_network(int num_addresses);

/// Empty inside of an own network.
const std::string& reason_without_own_network();

}  // namespace atrium::test_support
