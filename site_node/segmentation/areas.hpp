#pragma once

#include "core/image/image.hpp"

#include <array>
#include <vector>

namespace atrium::segmentation {

/// Corners in delivered (distorted) pixels [px]. Inside by the even-odd rule.
using AreaPolygon = std::vector<std::array<double, 2>>;

/// Areas of one camera in which segmentation looks for people. Everything else is background.
struct SegmentationAreas {
    std::vector<AreaPolygon> include;  // empty: the whole picture
    std::vector<AreaPolygon> exclude;  // cut out of `include`

    bool everywhere() const { return include.empty() && exclude.empty(); }
};

/// Returns a mask with 255 at pixels whose centre lies in one of `include` (anywhere if it is
/// empty) and in none of `exclude`, else 0.
image::Mask rasterise(const SegmentationAreas& areas, int width, int height);

}  // namespace atrium::segmentation
