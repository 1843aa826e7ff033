#pragma once

#include <cstdint>

namespace atrium::test {

/// Number of calls of operator new in this process so far, by all threads. Link
/// atrium_allocation_counter.
std::uint64_t num_allocations();

}  // namespace atrium::test
