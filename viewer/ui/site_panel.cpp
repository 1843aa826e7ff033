#include "viewer/ui/site_panel.hpp"

#include "viewer/ui/ui_scale.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

void draw_line(const SiteLine& line, bool is_chosen, std::string& chosen, SurfaceEvents& events) {
    ImGui::PushID(line.name.c_str());
    ImGui::TableNextColumn();
    bool is_shown = line.is_shown;
    if (ImGui::Checkbox("##shown", &is_shown)) events.hide_site = line.name;
    ImGui::TableNextColumn();
    if (ImGui::RadioButton("##solo", line.is_solo)) events.solo_site = line.name;
    ImGui::TableNextColumn();
    const std::string title =
        line.number > 0 ? fmt::format("{}  {}", line.number, line.name) : line.name;
    if (ImGui::Selectable(title.c_str(), is_chosen)) chosen = line.name;
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(line.rate.c_str());
    ImGui::TableNextColumn();
    if (line.is_warning)
        ImGui::TextColored(kWarningColour, "%s", line.state.c_str());
    else
        ImGui::TextUnformatted(line.is_shown ? line.state.c_str() : "hidden");
    ImGui::PopID();
}

}  // namespace

void SitePanel::move_choice(const std::vector<SiteLine>& sites) {
    const int step = std::exchange(wanted_step_, 0);
    if (sites.empty()) {
        chosen_.clear();
        return;
    }
    const auto found =
        std::ranges::find_if(sites, [&](const SiteLine& line) { return line.name == chosen_; });
    const auto last = static_cast<std::ptrdiff_t>(sites.size()) - 1;
    const std::ptrdiff_t at = found == sites.end() ? 0 : found - sites.begin() + step;
    chosen_ = sites[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at, 0, last))].name;
}

void SitePanel::draw(const HudContent& content, SurfaceEvents& events) {
    move_choice(content.sites);
    begin_arranged_panel("sites");
    ImGui::Text("%zu %s", content.sites.size(), content.sites.size() == 1 ? "site" : "sites");
    if (ImGui::BeginTable("sites", 5, ImGuiTableFlags_SizingFixedFit)) {
        for (const char* title : {"show", "solo", "site", "meshes", "state"})
            ImGui::TableSetupColumn(title);
        ImGui::TableHeadersRow();
        for (const SiteLine& line : content.sites)
            draw_line(line, line.name == chosen_, chosen_, events);
        ImGui::EndTable();
    }
    ImGui::TextColored(kHintColour, "%s", "Up, Down: choose   X: hide   O: solo   L: close");
    ImGui::End();
}

}  // namespace atrium::viewer
