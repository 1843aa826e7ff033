#pragma once

#include "site_node/segmentation/clean_mask.hpp"
#include "site_node/segmentation/pixel_test.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

// The stages of segmentation on whole pictures. The product runs them on strips.
namespace atrium::segmentation::test {

/// Rows [first, end) of a picture; both even.
struct RowRange {
    int first = 0;
    int end = 0;
};

/// Tests the given rows; `out` has no padding.
inline void test_rows(const image::YuvView& frame,
                      const BackgroundModel& model,
                      std::int16_t inverse_gain,
                      InstructionSet instructions,
                      RowRange rows,
                      std::uint8_t* out) {
    for (int y = rows.first; y < rows.end; y += 2, out += 2 * model.width()) {
        test_part(frame,
                  model,
                  inverse_gain,
                  instructions,
                  {0, y, model.width(), 2},
                  {out, out + model.width()});
    }
}

/// Applies the majority to a whole mask; border rows repeat above and below it. `out` must be
/// another mask and is resized.
inline void majority_3x3(const image::Mask& in, CleanScratch& scratch, image::Mask& out) {
    if (out.width != in.width || out.height != in.height) out = image::Mask(in.width, in.height);
    const InstructionSet instructions = best_instruction_set();
    for (int y = 0; y < in.height; ++y) {
        segmentation::majority_3x3({in.row(std::max(y - 1, 0)),
                                    in.row(y),
                                    in.row(std::min(y + 1, in.height - 1)),
                                    in.width},
                                   instructions,
                                   scratch,
                                   out.row(y));
    }
}

/// Removes small parts from a whole mask.
inline void remove_small_parts(image::Mask& mask,
                               int min_area_px,
                               int max_hole_px,
                               CleanScratch& scratch) {
    start_runs(scratch);
    for (int y = 0; y < mask.height; ++y)
        add_runs(mask.row(y), mask.width, {0, mask.width}, scratch);
    image::SparseMask sparse{std::move(mask), {}};
    sparse.forget();
    remove_small_runs(sparse, min_area_px, max_hole_px, scratch);
    mask = std::move(sparse.mask);
}

}  // namespace atrium::segmentation::test
