#pragma once

#include "tests/fuzz/hull_input.hpp"

#include <string>

namespace atrium::test {

/// Computes the hull of `input` several times. It must be a sound mesh or none, and have the same
/// bits with a used scratch and with two workers. Returns the violation, or "".
std::string check_hull(const HullInput& input);

}  // namespace atrium::test
