#include "site_node/segmentation/areas.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::segmentation {
namespace {

// Returns the first pixel whose centre is not left of `x`.
int pixel_from(double x, int width) {
    return static_cast<int>(std::clamp(std::ceil(x), 0.0, static_cast<double>(width)));
}

void fill(const AreaPolygon& polygon, std::uint8_t value, image::Mask& mask) {
    std::vector<double> crossings;
    for (int y = 0; y < mask.height; ++y) {
        crossings.clear();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const auto& a = polygon[i];
            const auto& b = polygon[(i + 1) % polygon.size()];
            if ((a[1] <= y) == (b[1] <= y)) continue;
            crossings.push_back(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
        }
        std::sort(crossings.begin(), crossings.end());
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
            std::fill(mask.row(y) + pixel_from(crossings[i], mask.width),
                      mask.row(y) + pixel_from(crossings[i + 1], mask.width),
                      value);
        }
    }
}

}  // namespace

image::Mask rasterise(const SegmentationAreas& areas, int width, int height) {
    image::Mask mask(width, height, areas.include.empty() ? 255 : 0);
    for (const AreaPolygon& polygon : areas.include) fill(polygon, 255, mask);
    for (const AreaPolygon& polygon : areas.exclude) fill(polygon, 0, mask);
    return mask;
}

}  // namespace atrium::segmentation
