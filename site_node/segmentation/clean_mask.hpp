#pragma once

#include "core/image/image.hpp"
#include "core/image/sparse_mask.hpp"
#include "site_node/segmentation/pixel_test.hpp"

#include <cstdint>
#include <vector>

namespace atrium::segmentation {

/// Reusable memory of the functions below.
struct CleanScratch {
    struct Run {
        std::int32_t begin;
        std::int32_t end;
        std::uint32_t
            component;       // index of another run of the component; the first points at itself
        std::uint32_t area;  // of the component, in its first run
    };
    std::vector<Run> runs;
    std::vector<std::uint32_t> first_run_of_row;
    std::vector<std::int8_t> column_votes;
};

/// Sets each pixel to the majority (5 of 9) of its 3x3 neighbourhood. Border pixels repeat beside
/// the row. The three rows hold 0 or 255; `out` must be another row. All instruction sets give the
/// same bits.
struct ThreeRows {
    const std::uint8_t* above;
    const std::uint8_t* here;
    const std::uint8_t* below;
    int width;
};
void majority_3x3(const ThreeRows& in,
                  InstructionSet instructions,
                  CleanScratch& scratch,
                  std::uint8_t* out);

/// Inverts each connected part of foreground (4-connected) with fewer than `min_area_px` pixels,
/// and of background (8-connected) with fewer than `max_hole_px`. Measures all parts before it
/// changes any: a speck inside a hole that is itself too small becomes background.
///
/// In steps, to read rows while they are in the cache: `start_runs`, `add_runs` for each row from
/// the top, then `remove_small_runs`. A row is background outside `span`. Widens the row spans of
/// `mask` where it fills holes outside them.
void start_runs(CleanScratch& scratch);
void add_runs(const std::uint8_t* row,
              int width,
              const image::PixelSpan& span,
              CleanScratch& scratch);
void remove_small_runs(image::SparseMask& mask,
                       int min_area_px,
                       int max_hole_px,
                       CleanScratch& scratch);

}  // namespace atrium::segmentation
