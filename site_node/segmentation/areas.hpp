#pragma once

#include "core/image/image.hpp"

#include <array>
#include <vector>

namespace atrium::segmentation {

/// Corners [px], distorted pixels as the camera delivers them; inside by the even-odd rule.
using AreaPolygon = std::vector<std::array<double, 2>>;

/// Where in the pictures of one camera people are looked for; elsewhere is background.
struct SegmentationAreas {
    std::vector<AreaPolygon> include;  // none: everywhere
    std::vector<AreaPolygon> exclude;  // of what is included

    bool everywhere() const { return include.empty() && exclude.empty(); }
};

/// 255 at pixels whose centre lies in one of `include` (or anywhere, if there is none) and in none
/// of `exclude`, else 0.
image::Mask rasterise(const SegmentationAreas& areas, int width, int height);

}  // namespace atrium::segmentation
