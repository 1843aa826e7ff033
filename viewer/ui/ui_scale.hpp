#pragma once

#include <array>
#include <optional>

namespace atrium::viewer {

/// Sizes of panels and letters for a picture. 1 is made for 1280x720.
///
/// `wanted`: view.ui_scale; 0: as the picture's height and the display's content scale require, so
/// that letters are as large a share of a large picture as of a small one; smaller in a picture
/// narrower than high. Steps of 0.25.
double ui_scale_of(double wanted, const std::array<int, 2>& size_px, double content_scale);

/// Letters and sizes of ImGui. Needs ImGui's context with its OpenGL 3 backend.
class UiSizes {
public:
    /// Loads the font at that scale if it changed. Call it between two ImGui frames.
    void set_scale(double scale);

private:
    std::optional<double> scale_;
};

/// Converts a length at scale 1 to the current scale [px]. Inside an ImGui frame.
float ui_px(double at_scale_1_px);

}  // namespace atrium::viewer
