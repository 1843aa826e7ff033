#pragma once

#include "site_node/coherence/coherence.hpp"

#include <string>

namespace atrium::coherence {

/// "turned by 0.20 degrees and moved by 10 mm": what is certain of a camera that was moved.
std::string motion_text(const NamedFault& fault);

/// "check its trigger, or shift its pictures by -1": the cure of a camera that is late.
std::string late_cure(const NamedFault& fault);

/// A sentence about a camera that is late, with the cure. `rate_hz`: of the instants; 0: unknown.
std::string late_text(const NamedFault& fault, const std::string& camera, double rate_hz);

}  // namespace atrium::coherence
