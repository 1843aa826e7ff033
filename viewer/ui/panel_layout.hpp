#pragma once

#include <cstdint>
#include <vector>

namespace atrium::viewer {

/// A panel on the picture [px], y downwards.
struct PanelBox {
    float left = 0.0f;
    float top = 0.0f;
    float width = 0.0f;
    float height = 0.0f;
};

enum class Corner : std::uint8_t {
    kUpperLeft,
    kUpperRight,
    kLowerLeft,
    kLowerRight,
    kUpperMiddle,  // only for messages, as kMiddle
    kMiddle,
};

/// A panel that wants to be shown, as large as its content.
struct PanelWish {
    Corner corner = Corner::kUpperLeft;
    float width = 0.0f;
    float height = 0.0f;
};

/// Where panels may lie [px].
struct PanelRoom {
    float width = 0.0f;  // of the picture
    float height = 0.0f;
    float margin = 0.0f;     // between panels, and around them
    float scrollbar = 0.0f;  // width of the bar of a panel that scrolls
};

/// The part of a box that another one covers. Width or height is 0 if it covers none.
PanelBox common_part(const PanelBox& a, const PanelBox& b);

/// Moves a panel so that it covers none of `taken`, and stays within a picture of that size and
/// `margin` away from its edges. Of several places the one nearest to `wanted`; if every place
/// covers a panel, the one that covers least.
PanelBox free_place(const PanelBox& wanted,
                    const std::vector<PanelBox>& taken,
                    float width,
                    float height,
                    float margin);

/// Places of all panels, in the order of the wishes. None covers another one, and all lie within
/// the picture. Where they have room, each is as large as its content and near its corner. Else
/// they stand in a left and a right column, and those that are cut must scroll.
std::vector<PanelBox> lay_out_panels(const std::vector<PanelWish>& wishes, const PanelRoom& room);

}  // namespace atrium::viewer
