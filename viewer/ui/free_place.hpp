#pragma once

#include <vector>

namespace atrium::viewer {

/// A panel on the picture [px], y downwards.
struct PanelBox {
    float left = 0.0f;
    float top = 0.0f;
    float width = 0.0f;
    float height = 0.0f;
};

/// Moves a panel so that it covers none of `taken`, and stays within a picture of that size and
/// `margin` away from its edges. Of several places the one nearest to `wanted`; if every place
/// covers a panel, the one that covers least.
PanelBox free_place(const PanelBox& wanted,
                    const std::vector<PanelBox>& taken,
                    float width,
                    float height,
                    float margin);

}  // namespace atrium::viewer
