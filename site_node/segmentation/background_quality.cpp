#include "site_node/segmentation/background_quality.hpp"

#include <algorithm>

namespace atrium::segmentation {

BackgroundQuality background_quality(const BackgroundStatistics& room,
                                     const SegmentationOptions& options) {
    BackgroundQuality quality;
    if (room.luma.empty()) return quality;
    std::vector<std::uint8_t> sigmas = room.luma_sigma;
    const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
    std::nth_element(sigmas.begin(), middle, sigmas.end());
    quality.noise = *middle / 4.0;
    const auto usable = [&](std::uint16_t luma) {
        return luma >= 256.0 * options.dark_luma && luma < 256 * kClipped;
    };
    quality.coverage =
        static_cast<double>(std::count_if(room.luma.begin(), room.luma.end(), usable)) /
        static_cast<double>(room.luma.size());
    return quality;
}

}  // namespace atrium::segmentation
