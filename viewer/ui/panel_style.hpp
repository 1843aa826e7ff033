#pragma once

#include <imgui.h>

#include <cstdint>

namespace atrium::viewer {

inline const ImVec4 kHintColour{0.75f, 0.77f, 0.8f, 1.0f};
inline const ImVec4 kWarningColour{1.0f, 0.75f, 0.3f, 1.0f};

enum class Corner : std::uint8_t { kUpperLeft, kLowerLeft, kLowerRight, kMiddle };

/// Places the next ImGui window in the upper left corner, or in the middle, of the picture.
void place_in(Corner corner);

/// Places the next ImGui window at the lower edge of the picture, to the right of `left` [px].
void place_below(float left);

/// Places the next ImGui window, a panel of that name, in a lower corner, or where it does not
/// cover the panels that were laid out before it in this frame.
void place_beside_others(const char* name, Corner corner);

/// Whether a colour picker or list is open over the panels.
bool is_popup_open();

/// Closes the colour picker or list that is open over the panels. Returns whether there was one.
bool close_popup();

/// Begins a panel at the place that was set, see place_below.
void begin_placed_panel(const char* name, double share, bool takes_input = true);

/// Begins a panel as large as its content, in a corner of the picture, at most `share` of the
/// picture's width; scrolls beyond its height. `takes_input`: false: the mouse goes through it to
/// the world. End it with ImGui::End.
void begin_panel(const char* name, Corner corner, double share, bool takes_input = true);

}  // namespace atrium::viewer
