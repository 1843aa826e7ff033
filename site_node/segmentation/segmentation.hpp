#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/clean_mask.hpp"
#include "site_node/segmentation/pixel_test.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

namespace atrium::segmentation {

/// Reused memory; one per thread.
struct SegmentationScratch {
    PixelTestScratch pixel_test;
    CleanScratch clean;
    image::Mask raw;
};

/// Tells who does not belong to the empty room: per-pixel test, 3x3 majority, removal of small
/// parts. `model` was finished with the same options. An error if the sizes of frame and model
/// differ. Allocates only while `scratch` and `out` grow.
Expected<void> segment(const image::YuvView& frame,
                       const BackgroundModel& model,
                       const SegmentationOptions& options,
                       SegmentationScratch& scratch,
                       image::Mask& out);

}  // namespace atrium::segmentation
