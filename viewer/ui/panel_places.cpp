#include "viewer/ui/panel_places.hpp"

#include "viewer/ui/panel_style.hpp"

#include <imgui.h>
// for the sizes of the panels
#include <imgui_internal.h>

#include <algorithm>

namespace atrium::viewer {

// What the content took in the last picture, with its borders.
PanelWish PanelPlaces::wish_of(const PanelAsk& ask) {
    const ImGuiWindow& window = *ImGui::FindWindowByName(ask.name);
    const ImGuiWindowTempData& content = window.DC;
    const ImVec2 most(std::max(content.CursorMaxPos.x, content.IdealMaxPos.x),
                      std::max(content.CursorMaxPos.y, content.IdealMaxPos.y));
    const ImVec2 padding = ImGui::GetStyle().WindowPadding;
    Width& width = widths_[ask.name];
    const float measured = most.x - content.CursorStartPos.x + 2.0f * padding.x;
    if (width.is_long != ask.is_long) width = {.is_long = ask.is_long, .num_settling = 2};
    // a panel that is cut breaks its lines earlier, and would never be wide again
    const bool is_settling = width.num_settling > 0;
    if (is_settling) --width.num_settling;
    width.wanted = ask.width_px > 0.0f ? ask.width_px
                   : is_settling       ? measured
                                       : std::max(width.wanted, measured);
    return {ask.corner, width.wanted, most.y - content.CursorStartPos.y + 2.0f * padding.y};
}

void PanelPlaces::arrange(std::span<const PanelAsk> shown, float taken_below_px) {
    ImVec2 size = ImGui::GetIO().DisplaySize;
    size.y = std::max(1.0f, size.y - taken_below_px);
    const ImGuiStyle& style = ImGui::GetStyle();
    const PanelRoom room{size.x, size.y, panel_margin(), style.ScrollbarSize};
    if (size.x != picture_.width || size.y != picture_.height || ImGui::GetFontSize() != letter_px_)
        widths_.clear();
    picture_ = {0.0f, 0.0f, size.x, size.y};
    letter_px_ = ImGui::GetFontSize();
    std::vector<const char*> names;
    std::vector<PanelWish> wishes;
    for (const PanelAsk& ask : shown) {
        if (ImGui::FindWindowByName(ask.name) == nullptr) continue;
        names.push_back(ask.name);
        wishes.push_back(wish_of(ask));
    }
    boxes_ = lay_out_panels(wishes, room);
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
        widths_[names[i]].given = boxes_[i].width;
        widths_[names[i]].scrolls = boxes_[i].height < wishes[i].height;
        ImGui::SetWindowPos(names[i], {boxes_[i].left, boxes_[i].top});
        ImGui::SetWindowSize(names[i], {boxes_[i].width, boxes_[i].height});
    }
}

float PanelPlaces::widest(const std::string& name) const {
    const auto found = widths_.find(name);
    const bool is_cut = found != widths_.end() && found->second.given < found->second.wanted;
    return is_cut ? found->second.given : widest_panel(1.0);
}

bool PanelPlaces::scrolls(const std::string& name) const {
    const auto found = widths_.find(name);
    return found != widths_.end() && found->second.scrolls;
}

}  // namespace atrium::viewer
