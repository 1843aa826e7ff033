#include "viewer/ui/panel_style.hpp"

#include "viewer/ui/free_place.hpp"
#include "viewer/ui/ui_scale.hpp"

// for the sizes of the other panels
#include <imgui_internal.h>

#include <vector>

namespace atrium::viewer {
namespace {

constexpr double kPanelMargin_px = 10.0;  // at scale 1

}  // namespace

void place_in(Corner corner) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float margin = ui_px(kPanelMargin_px);
    ImVec2 at{margin, margin};
    ImVec2 pivot{0.0f, 0.0f};
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

void place_beside_others(const char* name, Corner corner) {
    const ImGuiContext& context = *ImGui::GetCurrentContext();
    const ImGuiWindow* last = ImGui::FindWindowByName(name);
    const ImVec2 picture = ImGui::GetIO().DisplaySize;
    const float margin = ui_px(kPanelMargin_px);
    PanelBox wanted{margin, 0.0f, 0.0f, 0.0f};
    if (last != nullptr) {
        wanted.width = last->Size.x;
        wanted.height = last->Size.y;
    }
    wanted.top = picture.y - margin - wanted.height;
    if (corner == Corner::kLowerRight) wanted.left = picture.x - margin - wanted.width;
    constexpr int kNoPanel =
        ImGuiWindowFlags_ChildWindow | ImGuiWindowFlags_Tooltip | ImGuiWindowFlags_Popup;
    std::vector<PanelBox> others;
    for (const ImGuiWindow* window : context.Windows) {
        const bool is_panel = window->WasActive && window->LastFrameActive == context.FrameCount &&
                              !window->IsFallbackWindow && (window->Flags & kNoPanel) == 0;
        if (is_panel && window != last)
            others.push_back({window->Pos.x, window->Pos.y, window->Size.x, window->Size.y});
    }
    const PanelBox place = free_place(wanted, others, picture.x, picture.y, margin);
    ImGui::SetNextWindowPos({place.left, place.top});
}

bool is_popup_open() {
    return ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
}

bool close_popup() {
    if (!is_popup_open()) return false;
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
