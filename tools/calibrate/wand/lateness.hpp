#pragma once

#include "tools/calibrate/wand/solve_wand.hpp"

#include <cstddef>

namespace atrium::calibrate {

/// How late the pictures of a camera are, by which the motion of the lights explains its errors
/// [instants]; 0 if nothing moves.
double small_lateness(const WandSolution& solution, std::size_t camera);

/// The same for a camera that contradicts the others: places it anew from `nominal`, with its
/// pictures up to three instants earlier and later.
double large_lateness(const WandSolution& solution,
                      std::size_t camera,
                      const BundleCamera& nominal,
                      int num_threads);

}  // namespace atrium::calibrate
