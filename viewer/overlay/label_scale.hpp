#pragma once

#include <algorithm>

namespace atrium::viewer {

/// Height of a picture for which sizes are 1 (`view.ui_scale`).
inline constexpr double kReferenceHeight_px = 720.0;

/// Height of labels in the world for `view.ui_scale`, relative to their usual share of the
/// picture's height. 0: that share.
inline double label_scale_of(double ui_scale, int height_px) {
    if (ui_scale <= 0.0 || height_px <= 0) return 1.0;
    return std::clamp(ui_scale * kReferenceHeight_px / height_px, 0.2, 4.0);
}

}  // namespace atrium::viewer
