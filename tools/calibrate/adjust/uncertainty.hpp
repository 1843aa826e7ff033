#pragma once

#include "tools/calibrate/adjust/bundle.hpp"

#include <vector>

namespace atrium::calibrate {

/// What the sightings leave open about a camera: standard deviations.
struct CameraUncertainty {
    double focal = 0.0;      // of f, as a share of it
    double centre_px = 0.0;  // of cx and cy, the larger one
    double place_m = 0.0;    // of the camera's centre, beside the first placed camera
};

/// Standard deviations of the placed cameras of an adjusted bundle whose wand is a body, if each
/// coordinate of the used sightings is off by `sigma_px` on its own: the inverse of the normal
/// equations without the wands' poses (Triggs et al., 2000, section 6). Values are as large as
/// their weak priors allow where the sightings say nothing. Cameras that saw nothing have zeros.
std::vector<CameraUncertainty> uncertainty_of(const Bundle& bundle,
                                              LensFreedom lens,
                                              double sigma_px);

}  // namespace atrium::calibrate
