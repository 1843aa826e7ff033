#pragma once

#include "tools/calibrate/conclude_up.hpp"
#include "tools/calibrate/judge/choose_up.hpp"

#include <span>

namespace atrium::calibrate {

/// What is known of a rig besides the measured heights.
struct RigBefore {
    std::span<const geometry::CalibratedCamera> cameras;  // in the frame of the file, in metres
    const UpChoice& found;                                // by the pictures
    bool is_up_said = false;
    bool has_frame = true;  // the frame of the file means something
};

/// Corrects `result`, which comes from the pictures or from the user, by two or more measured
/// heights: sets the floor, and up, unless the heights agree with an axis of the file or the user
/// has said it. Replaces the sentences if up changes.
void conclude_heights(UpConclusion& result, const RigBefore& rig, const Measurements& measured);

}  // namespace atrium::calibrate
