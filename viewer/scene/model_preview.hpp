#pragma once

#include "core/model/model_file.hpp"

#include <cstdint>
#include <vector>

namespace atrium::viewer {

/// A small grey picture of a model, for the list of models.
struct ModelPreview {
    static constexpr int kWidth = 128;
    static constexpr int kHeight = 96;
    static constexpr std::uint8_t kBackground = 0;

    /// Rows from above, each of kWidth greys. Empty: no picture.
    std::vector<std::uint8_t> greys;
};

/// Draws the model from the front right and above, +Z up, as large as fits. Empty without a
/// triangle of some extent.
ModelPreview draw_preview(const std::vector<model::ModelPart>& parts);

}  // namespace atrium::viewer
