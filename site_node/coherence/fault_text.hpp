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

/// "lenses 1.10 times as long as the rig says": of all cameras.
std::string lenses_text(double factor);

/// A sentence about lenses that are not those of the rig, without the cure's command. `with`: what
/// lowers the errors.
std::string other_lenses_text(double before_px, double after_px, const std::string& with);

}  // namespace atrium::coherence
