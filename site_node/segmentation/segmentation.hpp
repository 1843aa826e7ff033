#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"
#include "core/image/raw_image.hpp"
#include "site_node/segmentation/areas.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/clean_mask.hpp"
#include "site_node/segmentation/light_adaptation.hpp"
#include "site_node/segmentation/pixel_test.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

namespace atrium::segmentation {

/// Tells who does not belong to the empty room, picture by picture of one camera: compensation of
/// the light, per-pixel test, 3x3 majority, areas, removal of small parts.
///
/// Not thread-safe; cameras are independent of each other.
class Segmenter {
public:
    /// Finds nobody before a room was given.
    Segmenter() = default;
    Segmenter(BackgroundStatistics room,
              const SegmentationOptions& options,
              const SegmentationAreas& areas = {});

    /// Pictures in the order of time: the light is followed from one to the next. An error if size
    /// or mosaic differ from the room's. Allocates only while `out` and scratch memory grow.
    Expected<void> segment(const image::YuvView& frame, image::Mask& out);
    /// The same, making the picture as it is read; unless there is an error, all of it.
    Expected<void> segment(image::WorkingPicture& picture, image::Mask& out);

    const BackgroundModel& model() const { return model_; }

private:
    void test_and_clean(image::WorkingPicture& picture, image::Mask& out);

    SegmentationOptions options_;
    BackgroundModel model_;
    LightAdaptation light_;
    image::Mask areas_;              // empty: everywhere
    std::vector<std::uint8_t> raw_;  // a strip of rows, before the majority
    CleanScratch clean_;
};

}  // namespace atrium::segmentation
