#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/instruction_set.hpp"

#include <cstdint>

namespace atrium::segmentation {

/// `inverse_gain` of a picture as bright as the learned room.
constexpr std::int16_t kUnitGain = 1 << 14;

/// Width of the cells in which test_part reports foreground [px].
constexpr int kTestCell = 32;

/// Output of test_part for two whole rows y and y + 1.
struct TestedRows {
    std::uint8_t* top;
    std::uint8_t* bottom;
    // per cell from the left of the part: 1 if one of the rows has foreground; null: not needed
    std::uint8_t* cells = nullptr;
};

/// Writes 255 for each pixel that cannot be background, else 0, in a part of two rows: `part` is
/// {x, y, width, 2}, all numbers even. The sizes of frame and model must agree. `inverse_gain` (0
/// to below 2, in 1/16384) multiplies luma before the comparison.
///
/// In a mosaic each sample is tested as luma, against the learned sample at the same place.
///
/// A pixel is background if its luma lies in its interval and the chroma of its block equals that
/// of the empty room, scaled by the ratio of the lumas, up to noise. A shadow scales luma and
/// chroma alike and is therefore background. If the block is dark, or one of its four samples is
/// clipped, luma alone decides. All instruction sets give the same bits.
///
/// Based on: Petit et al., Multicamera Real-Time 3D Modeling for Telepresence and Remote
/// Collaboration (2010): Gaussian on chroma, interval on luma; and Horprasert et al., A Statistical
/// Approach for Real-time Robust Background Subtraction (1999): the brightness ratio. We differ:
/// integers only, chroma once per 2x2 block, no division; the darkest accepted shadow depends on
/// how well the hue of the surface distinguishes it from a dark object.
void test_part(const image::YuvView& frame,
               const BackgroundModel& model,
               std::int16_t inverse_gain,
               InstructionSet instructions,
               const image::PixelRect& part,
               const TestedRows& out);

}  // namespace atrium::segmentation
