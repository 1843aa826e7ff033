#pragma once

#include "core/image/image.hpp"
#include "core/image/raw_image.hpp"
#include "core/image/sparse_mask.hpp"
#include "site_node/segmentation/background_model.hpp"
#include "site_node/segmentation/instruction_set.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

#include <cstdint>
#include <vector>

namespace atrium::segmentation {

/// Adapts one camera's background to changing light: `inverse_gain` to sudden global changes,
/// `follow` to slow local ones. Both ignore the surroundings of people, taken from the previous
/// picture, and both are bounded by the options.
class LightAdaptation {
public:
    /// Returns the factor on the luma of this picture that gives the brightness of the model, in
    /// 1/16384. It is the median over places spread across the picture that are neither dark nor
    /// clipped. With too few places the previous factor remains; within half a percent of 1 it
    /// is 1. Converts these places of the picture.
    std::int16_t inverse_gain(image::WorkingPicture& picture,
                              const BackgroundModel& model,
                              const SegmentationOptions& options);

    /// Notes where people are. Then moves one strip of kStrip rows of the model, the next one at
    /// each call, towards the picture where it shows background up to noise. Converts that strip of
    /// the picture. All instruction sets give the same bits.
    void follow(image::WorkingPicture& picture,
                const image::SparseMask& mask,
                const SegmentationOptions& options,
                BackgroundModel& model,
                InstructionSet instructions = best_instruction_set());

    /// Size of the cells [px]; cells with people and their neighbours are not changed.
    static constexpr int kCell = 16;
    static constexpr int kStrip = 4;

private:
    struct Follow {
        std::int32_t share;      // of the difference that one visit removes, in 1/65536
        std::int32_t max_drift;  // of luma, in 1/256
        InstructionSet instructions;
    };
    void find_people(const image::SparseMask& people);
    void follow_part(const image::YuvView& frame,
                     const image::PixelRect& part,
                     const Follow& how,
                     BackgroundModel& model) const;
    bool is_near_people(int cell_x, int cell_y) const {
        return !near_people_.empty() &&
               near_people_[static_cast<std::size_t>(cell_y) * static_cast<std::size_t>(cells_x_) +
                            static_cast<std::size_t>(cell_x)] != 0;
    }

    std::int16_t inverse_gain_ = 1 << 14;
    int cells_x_ = 0;
    int cells_y_ = 0;
    int next_strip_ = 0;
    std::vector<std::uint8_t> has_people_;   // per cell
    std::vector<std::uint8_t> near_people_;  // per cell
    std::vector<std::int32_t> samples_;
};

}  // namespace atrium::segmentation
