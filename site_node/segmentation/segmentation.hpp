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
#include "site_node/segmentation/outline_refinement.hpp"
#include "site_node/segmentation/pixel_test.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

namespace atrium::segmentation {

/// Finds the foreground, the people, in successive pictures of one camera: light compensation,
/// per-pixel test, 3x3 majority, areas, removal of small parts, outline by local colours.
///
/// Tests two of every four rows everywhere, and the other two only in cells of 32 x 16 pixels with
/// foreground and their eight neighbours. A line of at most two rows can therefore end where it
/// runs more than a cell away from all other foreground; every other part has foreground in the
/// tested rows.
///
/// Not thread-safe. Cameras are independent.
class Segmenter {
public:
    /// Without a room it finds nobody.
    Segmenter() = default;
    Segmenter(BackgroundStatistics room,
              const SegmentationOptions& options,
              const SegmentationAreas& areas = {});

    /// Segments the next picture; pictures must come in time order, since the light is followed
    /// from one to the next. An error if size or mosaic differ from the room's. Allocates only
    /// while `out` and scratch memory grow.
    Expected<void> segment(const image::YuvView& frame, image::Mask& out);
    /// Like above, but converts the picture as it reads it: on success everything within 16 px of
    /// people is converted. Reuse `out`: rows that stay background are not written again. Gives way
    /// after each 16 rows.
    Expected<void> segment(image::WorkingPicture& picture,
                           image::SparseMask& out,
                           const GiveWay& give_way = {});

    const BackgroundModel& model() const { return model_; }
    /// By which the luma of the last picture was multiplied before the comparison.
    float inverse_gain() const {
        return static_cast<float>(inverse_gain_) / static_cast<float>(kUnitGain);
    }
    /// Whether a pixel lies in the areas where the camera looks.
    bool watches(int x, int y) const { return areas_.data.empty() || areas_.at(x, y) != 0; }

private:
    void test_and_clean(image::WorkingPicture& picture,
                        image::SparseMask& out,
                        const GiveWay& give_way);
    void test_first_rows(image::WorkingPicture& picture, int cell_row, std::int16_t inverse_gain);
    void test_remaining_rows(image::WorkingPicture& picture,
                             int cell_row,
                             std::int16_t inverse_gain);
    image::PixelSpan active_columns(int cell_row) const;
    void clean_row(int y, const image::PixelSpan& columns, image::SparseMask& out);
    std::uint8_t* raw_row(int y);

    SegmentationOptions options_;
    BackgroundModel model_;
    LightAdaptation light_;
    std::int16_t inverse_gain_ = kUnitGain;
    image::Mask areas_;                      // empty: the whole picture
    image::SparseMask whole_;                // for callers without a sparse mask
    std::vector<std::uint8_t> raw_;          // some rows before the majority, cyclic
    std::vector<std::uint8_t> has_people_;   // per cell
    std::vector<std::uint8_t> near_people_;  // of one row of cells
    CleanScratch clean_;
    OutlineRefinement outline_;
};

}  // namespace atrium::segmentation
