#pragma once

#include <string>

namespace atrium::test {

/// The root of the source tree, where deploy/ and qos/ are. Only one source knows this path, so
/// that compilers can share all other results between clones. Part of every test.
const std::string& source_dir();

}  // namespace atrium::test
