#pragma once

#include "viewer/ui/panel_layout.hpp"

#include <map>
#include <span>
#include <string>
#include <vector>

namespace atrium::viewer {

/// A panel that a picture shows.
struct PanelAsk {
    const char* name;
    Corner corner;
    float width_px = 0.0f;  // 0: as its content; it only grows, so that its neighbours stay
    bool is_long = false;   // another form of the panel, with a width of its own
};

/// Places all panels of a picture: the only piece of layout that does. Panels that do not fit
/// beside each other get less room and scroll.
class PanelPlaces {
public:
    /// Call it in an ImGui frame before the panels, which `begin_arranged_panel` begins. A new
    /// panel is hidden for one picture, in which ImGui finds its size. `taken_below_px`: height of
    /// the picture's lower part that has no room for them.
    void arrange(std::span<const PanelAsk> shown, float taken_below_px = 0.0f);

    /// Width that a panel may have [px].
    float widest(const std::string& name) const;
    /// Whether the panel is higher than its place.
    bool scrolls(const std::string& name) const;
    /// Places in the last picture.
    const std::vector<PanelBox>& boxes() const { return boxes_; }

private:
    PanelWish wish_of(const PanelAsk& ask);

    struct Width {
        float wanted = 0.0f;
        float given = 0.0f;
        bool scrolls = false;
        bool is_long = false;
        int num_settling = 0;  // pictures until the panel has the width of its new form
    };
    std::map<std::string, Width> widths_;
    std::vector<PanelBox> boxes_;
    PanelBox picture_;  // and the size of the letters, for which `widths_` are valid
    float letter_px_ = 0.0f;
};

}  // namespace atrium::viewer
