#pragma once

#include "viewer/ui/keys.hpp"
#include "viewer/ui/surface.hpp"

namespace atrium::viewer {

/// Lays out the panel of statistics, at most `widest` pixels wide; `has_details` adds the stage
/// times of sites and worlds. Call between ImGui's NewFrame and Render.
void draw_hud(const HudContent& content, bool has_details, float widest);

/// Lays out the question whether kClose, kReset or kOtherWorld is meant, over all panels. Call
/// between ImGui's NewFrame and Render.
void draw_question(Action action);

/// Lays out the list of keys. Call between ImGui's NewFrame and Render.
void draw_keys();

}  // namespace atrium::viewer
