#pragma once

#include "site_node/segmentation/background_model.hpp"

namespace atrium::segmentation {

/// How good a model is, for one line of a log.
struct BackgroundQuality {
    double noise = 0.0;     // median deviation of luma [grey levels]
    double coverage = 0.0;  // share of the pixels that are neither dark nor clipped: that both luma
                            // and chroma are tested of
};

BackgroundQuality background_quality(const BackgroundStatistics& room,
                                     const SegmentationOptions& options);

}  // namespace atrium::segmentation
