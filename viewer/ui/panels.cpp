#include "viewer/ui/panels.hpp"

#include "viewer/ui/hud.hpp"
#include "viewer/ui/panel_style.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <string>
#include <vector>

namespace atrium::viewer {
namespace {

// The grey of a usual floor and sky: on a panel it is hardly seen.
constexpr ImU32 kUsualScene = IM_COL32(172, 176, 181, 255);

}  // namespace

void Panels::draw(const HudContent& content, SurfaceEvents& events) {
    open_.drag = content.edit.is_dragging;
    open_.selection = content.edit.selected.has_value();
    open_.following = !content.followed.empty();
    open_.eyes = !content.inside.empty();
    // the list of keys would cut the other panels
    opened_.has(Action::kKeys) ? draw_keys() : draw_panels(content, events);
    const bool has_panels = is_hud_shown_ || opened_.has(Action::kMenu) || open_.selection;
    if (has_panels && !content.notice.empty())
        draw_message("message", Corner::kUpperMiddle, content.notice);
    if (const auto asked = asked_.action(ImGui::GetTime())) draw_question(*asked);
}

void Panels::draw_panels(const HudContent& content, SurfaceEvents& events) {
    std::vector<PanelAsk> shown;
    const bool has_menu = opened_.has(Action::kMenu);
    const bool has_sites = opened_.has(Action::kSites);
    const bool has_views = opened_.has(Action::kViews);
    const bool has_details = opened_.has(Action::kDetails);
    if (is_hud_shown_) shown.push_back({"figures", Corner::kUpperLeft, 0.0f, has_details});
    if (has_menu) shown.push_back({"menu", Corner::kUpperRight, Menu::width()});
    if (open_.selection) shown.push_back({"edit", Corner::kLowerLeft, EditPanel::width()});
    if (has_sites) shown.push_back({"sites", Corner::kLowerLeft});
    if (has_views) shown.push_back({"viewpoints", Corner::kLowerRight});
    const bool has_timeline = content.timeline && is_hud_shown_;
    places_.arrange(shown, has_timeline ? timeline_.height_px() - panel_margin() : 0.0f);
    cover_names(content);
    if (is_hud_shown_)
        draw_hud(content,
                 {.has_details = has_details,
                  .scrolls = places_.scrolls("figures"),
                  .widest_px = places_.widest("figures")});
    if (has_menu) menu_.draw(content, events);
    edit_.draw(content, events);
    if (has_sites) sites_.draw(content, events);
    if (has_views) views_.draw(content, events);
    if (has_timeline) timeline_.draw(*content.timeline, events);
}

// Names lie in the picture, below the panels: they must not shine through their letters.
void Panels::cover_names(const HudContent& content) const {
    const ImVec2 picture = ImGui::GetIO().DisplaySize;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const PanelBox& panel : places_.boxes()) {
        for (const Eigen::AlignedBox2f& name : content.names) {
            const Eigen::Vector2f size = name.sizes();
            const PanelBox part = common_part(panel,
                                              {name.min().x() * picture.x,
                                               name.min().y() * picture.y,
                                               size.x() * picture.x,
                                               size.y() * picture.y});
            if (part.width > 0.0f && part.height > 0.0f)
                list.AddRectFilled({part.left, part.top},
                                   {part.left + part.width, part.top + part.height},
                                   kUsualScene);
        }
    }
}

bool Panels::allows(Action action) {
    // any other key takes back what a first one asked; Esc ends it
    if (action != Action::kClose) asked_.pressed(action);
    // a reset cannot be undone; some keyboards have Backspace where others have Delete
    const bool asks =
        action == Action::kReset || (action == Action::kOtherWorld && open_.selection);
    return !asks || asked_.is_confirmed(action, ImGui::GetTime());
}

bool Panels::change(Action action, SurfaceEvents& events) {
    switch (action) {
        case Action::kDetails:
        case Action::kMenu:
        case Action::kKeys:
        case Action::kSites:
        case Action::kViews:
            opened_.toggle(action);
            return true;
        case Action::kPanel:
            is_hud_shown_ = !is_hud_shown_;
            return true;
        case Action::kSavedWorlds:
            opened_.open(Action::kMenu);
            menu_.show_worlds();
            return true;
        case Action::kPreviousSite:
        case Action::kNextSite:
            sites_.choose(action == Action::kNextSite ? 1 : -1);
            return true;
        case Action::kHideSite:
            choose_site(events.hide_site, "X hides", events);
            return true;
        case Action::kSoloSite:
            choose_site(events.solo_site, "O shows only", events);
            return true;
        default:
            return false;
    }
}

// only what the user sees chosen
void Panels::choose_site(std::string& wanted, const char* what, SurfaceEvents& events) const {
    if (opened_.has(Action::kSites))
        wanted = sites_.chosen();
    else
        events.edit.hint = fmt::format("{} the site chosen in the list of sites: L", what);
}

bool Panels::close_last(SurfaceEvents& events) {
    const auto asked = asked_.action(ImGui::GetTime());
    open_.question = (asked && *asked != Action::kClose) || menu_.asks();
    open_.popup = is_popup_open();
    open_.panel = !opened_.is_empty();
    switch (escape_ends(open_)) {
        case EscapeEnds::kQuestion:
            asked_.take_back();
            menu_.take_back();
            return false;
        case EscapeEnds::kPopup:
            close_popup();
            return false;
        case EscapeEnds::kPanel:
            opened_.close_last();
            return false;
        case EscapeEnds::kDrag:
        case EscapeEnds::kSelection:
            events.edit.cancel = true;
            return false;
        case EscapeEnds::kFollowing:
            events.stop_following = true;
            return false;
        case EscapeEnds::kEyes:
            events.leave_eyes = true;
            return false;
        case EscapeEnds::kViewer:
            break;
    }
    // one Esc too many must not end a recording
    return asked_.is_confirmed(Action::kClose, ImGui::GetTime());
}

}  // namespace atrium::viewer
