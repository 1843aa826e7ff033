#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <cstdint>

namespace atrium::segmentation {

enum class InstructionSet : std::uint8_t { kBaseline, kAvx2 };

/// The best one that this processor has.
InstructionSet best_instruction_set();

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

}  // namespace atrium::segmentation
