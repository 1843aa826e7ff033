#pragma once

#include "viewer/ui/keys.hpp"
#include "viewer/ui/surface.hpp"

#include <string>

namespace atrium::viewer {

/// How the panel of statistics is shown.
struct HudForm {
    bool has_details = false;  // adds the stage times of sites and worlds
    bool scrolls = false;      // it has less room than it needs
    float widest_px = 0.0f;
};
/// Says whom to wait for while no person is shown: "1 site, no people yet".
std::string nobody_text(const HudContent& content);

/// Lays out the panel of statistics. Call between ImGui's NewFrame and Render.
void draw_hud(const HudContent& content, const HudForm& form);

/// Lays out the question whether kClose, kReset or kOtherWorld is meant, over all panels. Call
/// between ImGui's NewFrame and Render.
void draw_question(Action action);

/// Lays out the list of keys. Call between ImGui's NewFrame and Render.
void draw_keys();

}  // namespace atrium::viewer
