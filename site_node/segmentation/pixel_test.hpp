#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/instruction_set.hpp"

#include <cstdint>

namespace atrium::segmentation {

/// 1 of `inverse_gain`: the picture is as bright as the room was when it was learned.
constexpr std::int16_t kUnitGain = 1 << 14;

/// Rows [first, end) of a picture; both even.
struct RowRange {
    int first = 0;
    int end = 0;
};

/// Writes 255 where a pixel cannot be background, else 0: the given rows, without padding, to
/// `out`. Sizes of frame and model agree. `inverse_gain` (at least 0, in 1/16384, so below 2) is
/// what luma is multiplied by before it is compared.
///
/// In a mosaic each sample is tested as luma is, against the empty room's sample of the same place.
///
/// A pixel is background if its luma lies in its interval, and the chroma of its block is that of
/// the empty room, scaled by the ratio of the lumas, up to noise. So a shadow, which scales luma
/// and chroma alike, is background. Where the block is dark, or one of its four samples is clipped,
/// its chroma means nothing and luma alone decides. All sets of instructions give the same bits.
///
/// Based on: Petit et al., Multicamera Real-Time 3D Modeling for Telepresence and Remote
/// Collaboration (2010): Gaussian on chroma, interval on luma; and Horprasert et al., A Statistical
/// Approach for Real-time Robust Background Subtraction (1999): the brightness ratio. We differ:
/// integers only, chroma once per 2x2 block, no division; how dark a shadow may be depends on how
/// well the surface's hue tells it from a dark thing.
void test_rows(const image::YuvView& frame,
               const BackgroundModel& model,
               std::int16_t inverse_gain,
               InstructionSet instructions,
               RowRange rows,
               std::uint8_t* out);

/// Width of the cells in which test_part says where foreground is [px].
constexpr int kTestCell = 32;

/// Where the values of two whole rows y and y + 1 go.
struct TestedRows {
    std::uint8_t* top;
    std::uint8_t* bottom;
    // 1 where one of the rows has foreground in a cell, in cells from the left of the part; null:
    // nobody wants to know
    std::uint8_t* cells = nullptr;
};

/// The same for a part of two rows: `part` is {x, y, width, 2}, its numbers even.
void test_part(const image::YuvView& frame,
               const BackgroundModel& model,
               std::int16_t inverse_gain,
               InstructionSet instructions,
               const image::PixelRect& part,
               const TestedRows& out);

}  // namespace atrium::segmentation
