#pragma once

#include "viewer/ui/asked_again.hpp"
#include "viewer/ui/edit_panel.hpp"
#include "viewer/ui/escape_order.hpp"
#include "viewer/ui/keys.hpp"
#include "viewer/ui/menu.hpp"
#include "viewer/ui/panel_places.hpp"
#include "viewer/ui/site_panel.hpp"
#include "viewer/ui/surface.hpp"
#include "viewer/ui/timeline_panel.hpp"
#include "viewer/ui/viewpoint_panel.hpp"

namespace atrium::viewer {

/// All panels, messages and questions of a window, and the keys that open and close them. Inside an
/// ImGui context.
class Panels {
public:
    /// Lays them out, messages over panels, and writes the user's choices to `events`. Call between
    /// ImGui's NewFrame and Render.
    void draw(const HudContent& content, SurfaceEvents& events);

    /// Whether the key's action may happen: what cannot be undone needs it twice.
    bool allows(Action action);
    /// Does what the key asks of the panels. Returns false for other keys.
    bool change(Action action, SurfaceEvents& events);
    void toggle_keys() { opened_.toggle(Action::kKeys); }
    /// Ends what Esc ends next. Returns true if that is the viewer.
    bool close_last(SurfaceEvents& events);

private:
    void draw_panels(const HudContent& content, SurfaceEvents& events);
    void cover_names(const HudContent& content) const;
    void choose_site(std::string& wanted, const char* what, SurfaceEvents& events) const;

    bool is_hud_shown_ = true;
    OpenedPanels<Action> opened_;  // named by their keys
    Menu menu_;
    EditPanel edit_;
    SitePanel sites_;
    ViewpointPanel views_;
    TimelinePanel timeline_;
    PanelPlaces places_;
    AskedAgain asked_;
    Openings open_;  // as far as the last picture knows
};

}  // namespace atrium::viewer
