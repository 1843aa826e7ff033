#pragma once

#include "viewer/ui/surface.hpp"

namespace atrium::viewer {

/// Lays out the panel of statistics; `has_details` adds the stage times of sites and worlds. Call
/// between ImGui's NewFrame and Render.
void draw_hud(const HudContent& content, bool has_details);

/// Lays out the list of keys. Call between ImGui's NewFrame and Render.
void draw_keys();

}  // namespace atrium::viewer
