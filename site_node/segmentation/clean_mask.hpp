#pragma once

#include "core/image/image.hpp"

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
    std::vector<std::uint8_t> column_votes;
};

/// Each pixel becomes what at least 5 of its 3x3 neighbourhood are; outside the picture the border
/// pixels repeat. `out` is another mask than `in`, and is given its size.
void majority_3x3(const image::Mask& in, CleanScratch& scratch, image::Mask& out);

/// Turns over every connected part, foreground (4-connected) or background (8-connected), of fewer
/// than `min_area_px` pixels. All parts are measured before any is changed: a speck in a hole that
/// is too small as well becomes background there.
void remove_small_parts(image::Mask& mask, int min_area_px, CleanScratch& scratch);

}  // namespace atrium::segmentation
