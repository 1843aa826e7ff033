#pragma once

#include "viewer/ui/panel_layout.hpp"

#include <imgui.h>

#include <cstdint>
#include <string_view>

namespace atrium::viewer {

inline const ImVec4 kHintColour{0.75f, 0.77f, 0.8f, 1.0f};
inline const ImVec4 kWarningColour{1.0f, 0.75f, 0.3f, 1.0f};

/// Distance of panels from each other and from the edges of the picture [px].
float panel_margin();

/// Whether a key (ImGuiKey) goes down, or repeats, in this picture.
bool is_pressed(int key);

/// Whether a panel that takes the mouse lies there [px]. ImGui itself knows it one picture later.
bool is_panel_at(float x, float y);

/// Whether a colour picker or list is open over the panels.
bool is_popup_open();

/// Closes the colour picker or list that is open over the panels. Returns whether there was one.
bool close_popup();

enum class PanelKind : std::uint8_t {
    kInput,    // takes the mouse
    kText,     // the mouse goes through it to the world
    kCover,    // as kInput; hides what lies behind it
    kMessage,  // as kText; lies over all panels and hides what lies behind it
};

/// Begins a panel that PanelPlaces has placed. `width` [px] of a panel whose fields follow it; 0:
/// of one as wide as its content. End it with ImGui::End.
void begin_arranged_panel(const char* name, PanelKind kind = PanelKind::kInput, float width = 0.0f);

/// Greatest width [px] of a panel of that share of the picture's width: more in a narrow picture,
/// where it would cut its lines.
float widest_panel(double share);

/// Width [px] of a text in one line.
float text_width(std::string_view text);

/// The part of a text, up to a blank, that fits into that width [px]; at least one word.
std::string_view first_line(std::string_view text, float width);

/// Writes text that breaks between words only, where ImGui also breaks after the dots in names.
void draw_wrapped(std::string_view text);

/// Begins a panel as large as its content, in a corner or the middle of the picture, at most
/// `share` of the picture's width, see widest_panel; scrolls beyond its height. End it with
/// ImGui::End.
void begin_panel(const char* name, Corner corner, double share, PanelKind kind = PanelKind::kInput);

/// Shows a text over all panels, in the middle of the picture or at its upper edge. Nothing can be
/// clicked on it.
void draw_message(const char* name, Corner corner, std::string_view text);

}  // namespace atrium::viewer
