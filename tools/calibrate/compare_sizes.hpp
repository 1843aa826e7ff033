#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/foreign_rig.hpp"
#include "tools/calibrate/recording/gather.hpp"

namespace atrium::calibrate {

/// Gives each camera with frames the size of its pictures if the calibration has none, or if `said`
/// names that size or the one of the calibration, which the cameras already have. Error
/// kConfiguration, with the cure, for pictures that are turned, of another size than the
/// calibration, or of another one than said. Adds to `rig.problems` pictures of another shape.
Expected<void> compare_sizes(ForeignRig& rig, const Material& material, const Said& said);

}  // namespace atrium::calibrate
