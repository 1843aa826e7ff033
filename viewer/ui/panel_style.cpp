#include "viewer/ui/panel_style.hpp"

#include "viewer/ui/free_place.hpp"
#include "viewer/ui/ui_scale.hpp"

// for the sizes of the other panels
#include <imgui_internal.h>

#include <algorithm>
#include <vector>

namespace atrium::viewer {
namespace {

constexpr double kPanelMargin_px = 10.0;  // at scale 1
constexpr double kUncutPanel_px = 460.0;

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

float widest_panel(double share) {
    const float picture = ImGui::GetIO().DisplaySize.x;
    const float room = picture - 2.0f * ui_px(kPanelMargin_px);
    return std::max(static_cast<float>(share) * picture, std::min(room, ui_px(kUncutPanel_px)));
}

float text_width(std::string_view text) {
    return ImGui::CalcTextSize(text.data(), text.data() + text.size()).x;
}

std::string_view first_line(std::string_view text, float width) {
    std::size_t end = 0;
    while (end < text.size() && text[end] != '\n') {
        std::size_t next = text.find_first_not_of(' ', end);
        next = std::min(text.find_first_of(" \n", std::min(next, text.size())), text.size());
        if (end > 0 && text_width(text.substr(0, next)) > width) break;
        end = next;
    }
    return text.substr(0, end);
}

void draw_wrapped(std::string_view text) {
    const float wrap_at = ImGui::GetCurrentWindow()->DC.TextWrapPos;
    const float width =
        wrap_at > 0.0f ? wrap_at - ImGui::GetCursorPosX() : ImGui::GetContentRegionAvail().x;
    if (wrap_at <= 0.0f) ImGui::PushTextWrapPos(0.0f);  // breaks a word that is too long
    while (!text.empty()) {
        const std::string_view line = first_line(text, width);
        ImGui::TextUnformatted(line.data(), line.data() + line.size());
        text.remove_prefix(line.size());
        text.remove_prefix(std::min(text.find_first_not_of(" \n"), text.size()));
    }
    if (wrap_at <= 0.0f) ImGui::PopTextWrapPos();
}

bool is_panel_at(float x, float y) {
    return std::ranges::any_of(ImGui::GetCurrentContext()->Windows, [&](const ImGuiWindow* window) {
        return window->WasActive && !window->Hidden && !window->IsFallbackWindow &&
               (window->Flags & ImGuiWindowFlags_NoMouseInputs) == 0 &&
               window->Rect().Contains({x, y});
    });
}

bool is_popup_open() {
    return ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
}

bool close_popup() {
    if (!is_popup_open()) return false;
    ImGui::SetWindowFocus(nullptr);  // closes all
    return true;
}

void begin_panel(const char* name, Corner corner, double share, PanelKind kind) {
    place_in(corner);
    begin_placed_panel(name, share, kind);
}

void begin_placed_panel(const char* name, double share, PanelKind kind) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float margin = ui_px(kPanelMargin_px);
    ImGui::SetNextWindowSizeConstraints({0.0f, 0.0f},
                                        {widest_panel(share), size.y - 2.0f * margin});
    const bool takes_input = kind != PanelKind::kText;
    ImGui::SetNextWindowBgAlpha(kind == PanelKind::kCover ? 0.97f : takes_input ? 0.85f : 0.55f);
    int flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_HorizontalScrollbar;
    if (!takes_input) flags |= ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoScrollbar;
    ImGui::Begin(name, nullptr, flags);
}

}  // namespace atrium::viewer
