#pragma once

#include "viewer/surface.hpp"

namespace atrium::viewer {

/// Lays out the panel of figures. Between ImGui's NewFrame and Render.
void draw_hud(const HudFigures& figures);

/// Lists all keys. Likewise.
void draw_keys();

}  // namespace atrium::viewer
