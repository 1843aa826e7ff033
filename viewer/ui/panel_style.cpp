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
    if (corner == Corner::kLowerRight) {
        at = {size.x - margin, size.y - margin};
        pivot = {1.0f, 1.0f};
    }
    if (corner == Corner::kMiddle) {
        at = {0.5f * size.x, 0.5f * size.y};
        pivot = {0.5f, 0.5f};
    }
    ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
}

void place_below(float left) {
    const float margin = ui_px(kPanelMargin_px);
    const ImVec2 at{left + margin, ImGui::GetIO().DisplaySize.y - margin};
    ImGui::SetNextWindowPos(at, ImGuiCond_Always, {0.0f, 1.0f});
}

bool close_popup() {
    constexpr int kAny = ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel;
    if (!ImGui::IsPopupOpen("", kAny)) return false;
    ImGui::SetWindowFocus(nullptr);  // closes all
    return true;
}

void begin_panel(const char* name, Corner corner, double share, bool takes_input) {
    place_in(corner);
    begin_placed_panel(name, share, takes_input);
}

void begin_placed_panel(const char* name, double share, bool takes_input) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float margin = ui_px(kPanelMargin_px);
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
