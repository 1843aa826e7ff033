#pragma once

#include "tests/fuzz/hull_input.hpp"

#include <string>

namespace atrium::test {

/// Computes the hull of `input` several times: it has to be a sound mesh or none, and the same to
/// the bit on a scratch that was used for something else and with two workers. Empty: all is well;
/// else what is wrong.
std::string check_hull(const HullInput& input);

}  // namespace atrium::test
