#pragma once

#include "core/base/executor.hpp"
#include "core/base/expected.hpp"
#include "core/image/image.hpp"
#include "core/image/raw_image.hpp"
#include "core/image/sparse_mask.hpp"
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
/// Of every four rows, two are tested everywhere, and the other two only near foreground of those:
/// in cells of 32 x 16 pixels that have some, and their eight neighbours. So a line of at most two
/// rows can end where it runs more than a cell away from anything else; all other parts have
/// foreground in the rows that are tested.
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
    /// The same, making the picture as it is read: unless there is an error, all of it that lies
    /// within 16 px of people. Keep `out` together from call to call: rows that were background
    /// and stay so are not written again. Gives way after each 16 rows.
    Expected<void> segment(image::WorkingPicture& picture,
                           image::SparseMask& out,
                           const GiveWay& give_way = {});

    const BackgroundModel& model() const { return model_; }

private:
    void test_and_clean(image::WorkingPicture& picture,
                        image::SparseMask& out,
                        const GiveWay& give_way);
    void screen(image::WorkingPicture& picture, int cell_row, std::int16_t inverse_gain);
    void complete(image::WorkingPicture& picture, int cell_row, std::int16_t inverse_gain);
    image::PixelSpan active_columns(int cell_row) const;
    void clean_row(int y, const image::PixelSpan& columns, image::SparseMask& out);
    std::uint8_t* raw_row(int y);

    SegmentationOptions options_;
    BackgroundModel model_;
    LightAdaptation light_;
    image::Mask areas_;                      // empty: everywhere
    image::SparseMask whole_;                // of callers that have none
    std::vector<std::uint8_t> raw_;          // some rows before the majority, cyclic
    std::vector<std::uint8_t> has_people_;   // per cell
    std::vector<std::uint8_t> near_people_;  // of one row of cells
    CleanScratch clean_;
};

}  // namespace atrium::segmentation
