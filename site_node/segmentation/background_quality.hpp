#pragma once

#include "site_node/segmentation/background_model.hpp"

namespace atrium::segmentation {

/// Quality of a background, for the log.
struct BackgroundQuality {
    double noise = 0.0;     // median deviation of luma [grey levels]
    double coverage = 0.0;  // share of pixels neither dark nor clipped: luma and chroma are tested
};

BackgroundQuality background_quality(const BackgroundStatistics& room,
                                     const SegmentationOptions& options);

}  // namespace atrium::segmentation
