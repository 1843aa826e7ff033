#pragma once

#include "core/image/image.hpp"
#include "core/image/sparse_mask.hpp"
#include "site_node/segmentation/pixel_test.hpp"

#include <cstdint>
#include <vector>

namespace atrium::segmentation {

/// Reused memory of the two functions below.
struct CleanScratch {
    struct Run {
        std::int32_t begin;
        std::int32_t end;
        std::uint32_t component;  // index of another run of the same component; the first one
                                  // points at itself
        std::uint32_t area;       // of the component, in its first run
    };
    std::vector<Run> runs;
    std::vector<std::uint32_t> first_run_of_row;
    std::vector<std::int8_t> column_votes;
};

/// Each pixel becomes what at least 5 of its 3x3 neighbourhood are; beside the row the border
/// pixels repeat. `here`, and the rows above and below it, are 0 or 255, and `out` is another row.
/// All sets of instructions give the same bits.
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

/// The same for a whole picture; above and below it the border rows repeat. `out` is another mask
/// than `in`, and is given its size.
void majority_3x3(const image::Mask& in, CleanScratch& scratch, image::Mask& out);

/// Turns over every connected part of foreground (4-connected) of fewer than `min_area_px` pixels,
/// and of background (8-connected) of fewer than `max_hole_px`. All parts are measured before any
/// is changed: a speck in a hole that is too small as well becomes background there.
void remove_small_parts(image::Mask& mask, int min_area_px, int max_hole_px, CleanScratch& scratch);

/// The same in pieces, for rows that are best read while they are in the cache: after
/// `start_runs`, `add_runs` for each row from the top, then `remove_small_runs`.
void start_runs(CleanScratch& scratch);
void add_runs(const std::uint8_t* row, int width, CleanScratch& scratch);
/// Of a row that is background outside of `span`.
void add_runs(const std::uint8_t* row,
              int width,
              const image::PixelSpan& span,
              CleanScratch& scratch);
void remove_small_runs(image::Mask& mask, int min_area_px, int max_hole_px, CleanScratch& scratch);
/// Widens the rows of `mask` where it fills holes outside of them.
void remove_small_runs(image::SparseMask& mask,
                       int min_area_px,
                       int max_hole_px,
                       CleanScratch& scratch);

}  // namespace atrium::segmentation
