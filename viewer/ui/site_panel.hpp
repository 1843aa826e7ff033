#pragma once

#include "viewer/ui/panel_style.hpp"
#include "viewer/ui/surface.hpp"

#include <string>

namespace atrium::viewer {

/// The list of sites: hides them or shows only one, with the mouse or for the keys of the window.
class SitePanel {
public:
    /// Lays out the list and writes the user's choices to `events`. Inside an ImGui frame.
    void draw(const HudContent& content, SurfaceEvents& events);

    /// Chooses the next site, or the previous one.
    void choose(int step) { wanted_step_ += step; }
    /// The chosen site. Empty before the first `draw` with a site.
    const std::string& chosen() const { return chosen_; }

private:
    void move_choice(const std::vector<SiteLine>& sites);

    std::string chosen_;
    int wanted_step_ = 0;
};

}  // namespace atrium::viewer
