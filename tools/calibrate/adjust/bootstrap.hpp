#pragma once

#include "tools/calibrate/adjust/bundle.hpp"

#include <functional>

namespace atrium::calibrate {

struct BootstrapOptions {
    int num_threads = 1;
    /// Called with a short text when a step begins, or null.
    std::function<void(const std::string&)> report;
};

/// Places the cameras and wands of a bundle without any initial guess, from the nominal lenses:
/// the essential matrix of the best pair of cameras, the scale from the wand, then one camera after
/// the other by its sightings of lights that are known already, with an adjustment after each. The
/// focal lengths may be off by a third. Marks as unused the sightings that do not fit.
///
/// Errors kInvalidData: too few common sightings, or cameras that cannot be placed, by name, with
/// the cause that is most likely.
Expected<void> bootstrap(Bundle& bundle, const BootstrapOptions& options);

}  // namespace atrium::calibrate
