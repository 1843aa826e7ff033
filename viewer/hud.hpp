#pragma once

#include "viewer/surface.hpp"

namespace atrium::viewer {

/// Lays out the panel of figures, with how long sites and worlds take for what where
/// `has_details`. Between ImGui's NewFrame and Render.
void draw_hud(const HudFigures& figures, bool has_details);

/// Lists all keys. Likewise.
void draw_keys();

}  // namespace atrium::viewer
