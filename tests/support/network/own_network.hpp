#pragma once

#include <string>

namespace atrium::test_support {

/// Moves this test program into a private user and network namespace, whose loopback interface has
/// the addresses 127.0.0.1 to 127.0.0.`num_addresses`. If that is not permitted, the program stays
/// where it is, and `reason_without_own_network` returns the reason. Call this first in main,
/// before any thread starts.
void enter_own_network(int num_addresses);

/// Empty inside a private network.
const std::string& reason_without_own_network();

}  // namespace atrium::test_support
