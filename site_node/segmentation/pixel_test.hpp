#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <cstdint>
#include <vector>

namespace atrium::segmentation {

/// Reused memory of test_pixels: one row of blocks.
struct PixelTestScratch {
    std::vector<std::int16_t> luma_sum;
    std::vector<std::uint8_t> chroma_verdict;  // one byte per pixel column
};

enum class InstructionSet : std::uint8_t { kBaseline, kAvx2 };

/// The best one that this processor has.
InstructionSet best_instruction_set();

/// Writes 255 where a pixel cannot be background, else 0. Sizes of frame, model and `out` agree.
///
/// In a mosaic each sample is tested as luma is, against the empty room's sample of the same place.
///
/// A pixel is background if its luma lies in its interval, and the chroma of its block is that of
/// the empty room, scaled by the ratio of the lumas, up to noise. So a shadow, which scales luma
/// and chroma alike, is background. All sets of instructions give the same bits.
///
/// Based on: Petit et al., Multicamera Real-Time 3D Modeling for Telepresence and Remote
/// Collaboration (2010): Gaussian on chroma, interval on luma; and Horprasert et al., A Statistical
/// Approach for Real-time Robust Background Subtraction (1999): the brightness ratio. We differ:
/// integers only, chroma once per 2x2 block, no division.
void test_pixels(const image::YuvView& frame,
                 const BackgroundModel& model,
                 InstructionSet instructions,
                 PixelTestScratch& scratch,
                 image::Mask& out);

}  // namespace atrium::segmentation
