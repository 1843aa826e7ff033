#pragma once

namespace atrium::silhouette::test {

/// How often this program has asked for memory so far. The counting operator new is in its own
/// source file, so that the compiler does not see through it.
long num_allocations();

}  // namespace atrium::silhouette::test
