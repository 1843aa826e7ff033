#pragma once

#include "core/config/rig.hpp"
#include "tools/calibrate/adjust/bundle.hpp"

#include <optional>

namespace atrium::calibrate {

/// How well a rig explains what was seen of a wand or board: each light is triangulated from all
/// the rig's cameras that use it, without trust in the wand. RMS per coordinate [px]; the same
/// measure for every rig. Empty if the rig's cameras see no light together.
std::optional<double> sweep_error_px(const Bundle& seen, const config::Rig& rig);

}  // namespace atrium::calibrate
