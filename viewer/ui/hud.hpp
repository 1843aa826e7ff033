#pragma once

#include "viewer/ui/keys.hpp"
#include "viewer/ui/surface.hpp"

namespace atrium::viewer {

/// Lays out the panel of statistics; `has_details` adds the stage times of sites and worlds.
/// Returns its right edge. Call between ImGui's NewFrame and Render.
float draw_hud(const HudContent& content, bool has_details);

/// Lays out the question whether kClose or kReset is meant. Call between ImGui's NewFrame and
/// Render.
void draw_question(Action action);

/// Lays out the list of keys. Call between ImGui's NewFrame and Render.
void draw_keys();

}  // namespace atrium::viewer
