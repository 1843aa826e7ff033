#include "viewer/ui/panel_style.hpp"

#include "viewer/ui/ui_scale.hpp"

namespace atrium::viewer {
namespace {

constexpr double kPanelMargin_px = 10.0;  // at scale 1

}  // namespace

void place_in(Corner corner) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float margin = ui_px(kPanelMargin_px);
    ImVec2 at{margin, margin};
    ImVec2 pivot{0.0f, 0.0f};
    if (corner == Corner::kLowerLeft || corner == Corner::kLowerMiddle ||
        corner == Corner::kLowerRight) {
        at.y = size.y - margin;
        pivot.y = 1.0f;
    }
    if (corner == Corner::kLowerMiddle) {
        at.x = 0.5f * size.x;
        pivot.x = 0.5f;
    }
    if (corner == Corner::kLowerRight) {
        at.x = size.x - margin;
        pivot.x = 1.0f;
    }
    if (corner == Corner::kMiddle) {
        at = {0.5f * size.x, 0.5f * size.y};
        pivot = {0.5f, 0.5f};
    }
    ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
}

void begin_panel(const char* name, Corner corner, double share, bool takes_input) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float margin = ui_px(kPanelMargin_px);
    place_in(corner);
    ImGui::SetNextWindowSizeConstraints(
        {0.0f, 0.0f}, {static_cast<float>(share) * size.x, size.y - 2.0f * margin});
    ImGui::SetNextWindowBgAlpha(takes_input ? 0.85f : 0.55f);
    int flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_HorizontalScrollbar;
    if (!takes_input) flags |= ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoScrollbar;
    ImGui::Begin(name, nullptr, flags);
}

}  // namespace atrium::viewer
