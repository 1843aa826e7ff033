#pragma once

#include "core/image/image.hpp"
#include "core/image/sparse_mask.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/bit_rows.hpp"
#include "site_node/segmentation/instruction_set.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::segmentation {

/// Moves the outline of people to where their colours end. The per-pixel test also takes pixels for
/// people of which a person covers a tenth; here the border is where a person covers half.
///
/// Not thread-safe. Keeps its memory.
class OutlineRefinement {
public:
    /// Decides the pixels within two pixels inside and one pixel outside of the outline again, by
    /// the nearer of two colours: the mean of the person beside the pixel, and the learned room
    /// there, as dark as it is beside the person. In sharp pictures (edge_width.hpp) the person's
    /// counts as nearer. Pixels stay as they are where the two colours
    /// differ by less than kLeastContrast, and where people are too thin to have an inside. The
    /// majority of 3x3 follows.
    ///
    /// Sizes must agree. Outside `areas`, if it is not empty, nothing becomes a person. Everything
    /// within 16 px of `mask` must be converted. `inverse_gain` as in test_part. All instruction
    /// sets give the same bits. Widens the row spans of `mask`.
    void refine(const image::YuvView& picture,
                const BackgroundModel& model,
                std::int16_t inverse_gain,
                const image::Mask& areas,
                image::SparseMask& mask,
                InstructionSet instructions = best_instruction_set());

    static constexpr int kLeastContrast = 6;  // [grey levels], of luma and chroma

    /// Sums over the 2x2 blocks of a square of 4x4 pixels that are certainly a person ("inside"),
    /// or certainly not ("outside").
    struct TileSums {
        enum Index : std::uint8_t {
            kNumInside,
            kLuma,  // four, one per place within a block
            kU = kLuma + 4,
            kV,  // of U and V - 128
            kPictureLuma,
            kRoomLuma,  // in 1/256
            kEnd = 16
        };
        std::array<std::int32_t, kEnd> sums{};
        std::int32_t row = -1;  // of the tile; -1: of none yet
    };

private:
    BitRows people_, inner_, core_, outer_, band_;
    std::vector<TileSums> tiles_;  // of three rows of tiles, cyclic
};

}  // namespace atrium::segmentation
