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

/// Keeps up with light that changes, for one camera: at once and everywhere alike (`inverse_gain`),
/// or slowly and in places (`follow`). What is near people, as they were in the former picture, has
/// no say in either; both are bounded by the options.
class LightAdaptation {
public:
    /// What luma of this picture has to be multiplied by to be as bright as the model, in 1/16384:
    /// the median over places spread across the picture that are neither dark nor clipped. Where
    /// too few are left, the former one stays. Within half a percent of 1 it is 1. Makes those
    /// places of the picture.
    std::int16_t inverse_gain(image::WorkingPicture& picture,
                              const BackgroundModel& model,
                              const SegmentationOptions& options);

    /// Takes note of where people are, and lets one strip of the model, kStrip rows, the next one
    /// with each call, come closer to the picture where it shows background up to noise. Makes
    /// that strip of the picture. All sets of instructions give the same bits.
    void follow(image::WorkingPicture& picture,
                const image::SparseMask& mask,
                const SegmentationOptions& options,
                BackgroundModel& model,
                InstructionSet instructions = best_instruction_set());

    /// People keep their own and the neighbouring squares of this size [px] as they are.
    static constexpr int kCell = 16;
    static constexpr int kStrip = 4;

private:
    struct Follow {
        std::int32_t share;      // of the difference that one visit takes away, in 1/65536
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
