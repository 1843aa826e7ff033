#pragma once

#include <string>

namespace atrium::test_support {

/// Starts this test program again inside a user and a network namespace of its own, whose loopback
/// interface has the addresses 127.0.0.1 to 127.0.0.`num_addresses`, and ends with its exit code.
/// Returns at once in that second run, and where namespaces are not permitted: then
/// `reason_without_own_network` says why. First thing in main.
void run_in_own_network(char** argv, int num_addresses);

/// Empty inside of an own network.
const std::string& reason_without_own_network();

}  // namespace atrium::test_support
