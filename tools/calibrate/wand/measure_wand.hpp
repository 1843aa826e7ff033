#pragma once

#include "tools/calibrate/wand/solve_wand.hpp"

namespace atrium::calibrate {

/// Fills the figures of a solution whose bundle is adjusted and whose outliers are marked; all but
/// those of the search for lights and of held-out lights.
void measure_wand(WandSolution& solution);

}  // namespace atrium::calibrate
