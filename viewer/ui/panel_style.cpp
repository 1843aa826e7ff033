#include "viewer/ui/panel_style.hpp"

#include "viewer/ui/ui_scale.hpp"

// for the panels under the mouse and the order of the panels
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>

namespace atrium::viewer {
namespace {

constexpr double kPanelMargin_px = 10.0;  // at scale 1
constexpr double kUncutPanel_px = 460.0;

constexpr double kWidestMessage_px = 560.0;

int flags_of(PanelKind kind) {
    int flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                ImGuiWindowFlags_HorizontalScrollbar;
    if (kind == PanelKind::kText || kind == PanelKind::kMessage)
        flags |= ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoScrollbar;
    return flags;
}

float alpha_of(PanelKind kind) {
    if (kind == PanelKind::kText) return 0.55f;
    return kind == PanelKind::kInput ? 0.85f : 0.97f;
}

}  // namespace

float panel_margin() { return ui_px(kPanelMargin_px); }

float widest_panel(double share) {
    const float picture = ImGui::GetIO().DisplaySize.x;
    const float room = picture - 2.0f * panel_margin();
    return std::min(room, std::max(static_cast<float>(share) * picture, ui_px(kUncutPanel_px)));
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

bool is_pressed(int key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key)); }

bool is_popup_open() {
    return ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
}

bool close_popup() {
    if (!is_popup_open()) return false;
    ImGui::SetWindowFocus(nullptr);  // closes all
    return true;
}

void begin_panel(const char* name, Corner corner, double share, PanelKind kind) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float margin = panel_margin();
    ImVec2 at{margin, margin};
    ImVec2 pivot{0.0f, 0.0f};
    if (corner != Corner::kUpperLeft) at.x = 0.5f * size.x, pivot.x = 0.5f;
    if (corner == Corner::kMiddle) at.y = 0.5f * size.y, pivot.y = 0.5f;
    ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
    ImGui::SetNextWindowSizeConstraints({0.0f, 0.0f},
                                        {widest_panel(share), size.y - 2.0f * margin});
    ImGui::SetNextWindowBgAlpha(alpha_of(kind));
    ImGui::Begin(name, nullptr, flags_of(kind) | ImGuiWindowFlags_AlwaysAutoResize);
}

void begin_arranged_panel(const char* name, PanelKind kind, float width) {
    int flags = flags_of(kind);
    // its fields follow its width; for a panel that scrolls sideways ImGui keeps them too wide
    if (width > 0.0f) flags &= ~ImGuiWindowFlags_HorizontalScrollbar;
    if (ImGui::FindWindowByName(name) == nullptr) {
        // its first picture, in which nobody sees it
        if (width > 0.0f)
            ImGui::SetNextWindowSize({width, 0.0f});
        else
            flags |= ImGuiWindowFlags_AlwaysAutoResize;
    }
    ImGui::SetNextWindowBgAlpha(alpha_of(kind));
    ImGui::Begin(name, nullptr, flags);
}

void draw_message(const char* name, Corner corner, std::string_view text) {
    const ImVec2 padding = ImGui::GetStyle().WindowPadding;
    const float widest = std::min(ui_px(kWidestMessage_px), widest_panel(1.0) - 2.0f * padding.x);
    // its exact size at once: a panel that fits itself is too small for one picture
    ImVec2 size{0.0f, 0.0f};
    for (std::string_view rest = text; !rest.empty();) {
        const std::string_view line = first_line(rest, widest);
        size.x = std::max(size.x, std::min(widest, text_width(line)));
        // a word that is too long is broken
        size.y += ImGui::CalcTextSize(line.data(), line.data() + line.size(), false, widest).y +
                  ImGui::GetStyle().ItemSpacing.y;
        rest.remove_prefix(line.size());
        rest.remove_prefix(std::min(rest.find_first_not_of(" \n"), rest.size()));
    }
    size.x = std::ceil(size.x) + 1.0f;
    size.y -= ImGui::GetStyle().ItemSpacing.y;
    const ImVec2 picture = ImGui::GetIO().DisplaySize;
    const bool is_low = corner == Corner::kMiddle;
    ImGui::SetNextWindowPos({0.5f * picture.x, is_low ? 0.5f * picture.y : panel_margin()},
                            ImGuiCond_Always,
                            {0.5f, is_low ? 0.5f : 0.0f});
    ImGui::SetNextWindowSize({size.x + 2.0f * padding.x, size.y + 2.0f * padding.y});
    ImGui::SetNextWindowBgAlpha(alpha_of(PanelKind::kMessage));
    ImGui::Begin(name, nullptr, flags_of(PanelKind::kMessage));
    ImGui::PushTextWrapPos(padding.x + size.x);
    draw_wrapped(text);
    ImGui::PopTextWrapPos();
    ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());
    ImGui::End();
}

}  // namespace atrium::viewer
