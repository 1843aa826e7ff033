#pragma once

namespace atrium::silhouette::test {

/// Number of memory allocations of this program so far. The counting operator new is in its own
/// source file, because the compiler must not see through it.
long num_allocations();

}  // namespace atrium::silhouette::test
