#pragma once

#include "tests/support/world/acts.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace atrium::bench {

/// Makes an act from a seed.
using MakeAct = std::function<test::Act(std::uint64_t)>;

/// The acts with which benchmarks measure the motion of a person, by name.
const std::map<std::string, MakeAct>& trial_acts();

}  // namespace atrium::bench
