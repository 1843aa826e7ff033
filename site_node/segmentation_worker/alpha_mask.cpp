#include "site_node/segmentation_worker/alpha_mask.hpp"

namespace atrium::segmentation_worker {

void mask_of_alpha(const std::uint8_t* alpha,
                   const image::Mask& areas,
                   const segmentation::SegmentationOptions& options,
                   const GiveWay& give_way,
                   segmentation::CleanScratch& scratch,
                   image::SparseMask& out) {
    const int width = out.mask.width;
    out.forget();
    segmentation::start_runs(scratch);
    for (int y = 0; y < out.mask.height; ++y) {
        const std::uint8_t* const from = alpha + static_cast<std::ptrdiff_t>(y) * width;
        std::uint8_t* const row = out.mask.row(y);
        for (int x = 0; x < width; ++x) row[x] = from[x] >= kForeground ? 255 : 0;
        if (!areas.data.empty()) {
            const std::uint8_t* const area = areas.row(y);
            for (int x = 0; x < width; ++x) row[x] &= area[x];
        }
        segmentation::add_runs(row, width, {0, width}, scratch);
        if (y % 16 == 15) give_way();
    }
    segmentation::remove_small_runs(out, options.min_area_px, options.max_hole_px, scratch);
}

}  // namespace atrium::segmentation_worker
