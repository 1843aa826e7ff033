#include "viewer/ui/viewpoint_panel.hpp"

#include "viewer/ui/panel_style.hpp"
#include "viewer/ui/ui_scale.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

using ViewpointAsk = ViewpointEvent::Kind;
constexpr int kMaxNumber = 9;

}  // namespace

void ViewpointPanel::draw_line(const ViewpointLine& line, SurfaceEvents& events) {
    ImGui::PushID(line.number);
    ImGui::TableNextColumn();
    if (ImGui::Button(fmt::format("{}", line.number).c_str()))
        events.viewpoint = ViewpointEvent{ViewpointAsk::kGo, line.number, ""};
    ImGui::TableNextColumn();
    if (renamed_ == line.number) {
        ImGui::SetNextItemWidth(ui_px(180.0));
        // at once: letters typed without a field are keys of the viewer
        if (std::exchange(wants_focus_, false)) ImGui::SetKeyboardFocusHere();
        const bool is_done = ImGui::InputText(
            "##name",
            name_.data(),
            name_.size(),
            ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
        if (is_done && name_[0] != '\0')
            events.viewpoint = ViewpointEvent{ViewpointAsk::kRename, line.number, name_.data()};
        if (is_done || ImGui::IsItemDeactivated()) renamed_ = 0;
    } else if (ImGui::Selectable(line.name.c_str(), false, 0, {ui_px(180.0), 0.0f})) {
        events.viewpoint = ViewpointEvent{ViewpointAsk::kGo, line.number, ""};
    }
    ImGui::TableNextColumn();
    if (ImGui::SmallButton("rename")) {
        renamed_ = renamed_ == line.number ? 0 : line.number;
        wants_focus_ = renamed_ != 0;
        name_.fill('\0');
        std::copy_n(line.name.begin(), std::min(line.name.size(), name_.size() - 1), name_.begin());
    }
    ImGui::TableNextColumn();
    if (line.is_own) {
        // nothing brings a viewpoint back
        const bool asks = deleted_ == line.number;
        if (ImGui::SmallButton(asks ? "really?###delete" : "delete###delete")) {
            if (asks) events.viewpoint = ViewpointEvent{ViewpointAsk::kForget, line.number, ""};
            deleted_ = asks ? 0 : line.number;
        } else if (asks && !ImGui::IsItemHovered() && ImGui::IsMouseClicked(0)) {
            deleted_ = 0;
        }
    } else {
        ImGui::TextDisabled("of the file");
    }
    ImGui::PopID();
}

void ViewpointPanel::draw(const HudContent& content, SurfaceEvents& events) {
    begin_arranged_panel("viewpoints");
    const std::size_t num = content.viewpoints.size();
    ImGui::Text("%zu viewpoint%s", num, num == 1 ? "" : "s");
    if (ImGui::BeginTable("viewpoints", 4, ImGuiTableFlags_SizingFixedFit)) {
        for (const ViewpointLine& line : content.viewpoints) draw_line(line, events);
        ImGui::EndTable();
    }
    int free_number = 1;
    for (const ViewpointLine& line : content.viewpoints)
        free_number += line.number == free_number ? 1 : 0;
    ImGui::BeginDisabled(free_number > kMaxNumber);
    if (ImGui::Button(
            fmt::format("keep this viewpoint as {}", std::min(free_number, kMaxNumber)).c_str()))
        events.viewpoint = ViewpointEvent{ViewpointAsk::kKeep, free_number, ""};
    ImGui::EndDisabled();
    ImGui::TextColored(kHintColour, "%s", "Ctrl+1 ... 9: keep   Shift+1 ... 9: go   K: close");
    ImGui::End();
}

}  // namespace atrium::viewer
