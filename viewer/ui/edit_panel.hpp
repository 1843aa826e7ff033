#pragma once

#include "viewer/ui/panel_style.hpp"
#include "viewer/ui/surface.hpp"

#include <array>
#include <optional>
#include <string>

namespace atrium::viewer {

/// The panel of the selected object: name, size, mass, surface, colour and place. Sizes follow
/// ImGui's font. Call `draw` between ImGui's NewFrame and Render.
class EditPanel {
public:
    /// Shows nothing if no object is selected. Writes the user's changes to `events`, each when the
    /// user has let go of its field.
    void draw(const HudContent& content, SurfaceEvents& events);
    /// Width that it wants [px]. Inside an ImGui frame.
    static float width();

private:
    void load(const bus::SceneObject& object);
    bus::SceneObject form() const;
    std::string draw_fields(const bus::SceneObject& object);
    geometry::RigidTransform typed_pose(const geometry::RigidTransform& from) const;
    std::string draw_place(const EditView& edit, SurfaceEvents& events);
    void draw_buttons(const EditView& edit, SurfaceEvents& events);

    bus::SceneObject seen_;   // as the world had it when the fields were filled
    bus::SceneObject asked_;  // last change that was requested
    double asked_at_s_ = -1e9;
    std::array<char, 64> name_{};
    std::array<float, 3> size_m_{};
    float mass_kg_ = 0.0f;
    float movable_mass_kg_ = 1.0f;  // mass that a fixed object gets when it becomes movable
    bool is_fixed_ = false;
    float friction_ = 0.0f;
    float restitution_ = 0.0f;
    std::array<float, 3> colour_{};  // sRGB
    struct Held {
        geometry::RigidTransform from{};  // when the user took the field
        bool is_moved = false;            // since
    };
    std::optional<Held> held_;  // one of the two below is being edited
    std::array<float, 3> position_m_{};
    std::array<float, 3> angles_deg_{};
};

/// Lists of the models that can be added and of the saved worlds, for the menu.
class WorldPanel {
public:
    void draw(const HudContent& content, SurfaceEvents& events);
    /// Opens the list of saved worlds in the next `draw`.
    void show_worlds() { wants_worlds_ = true; }
    /// Whether a button waits for a second press.
    bool asks() const { return asks_load_ || asks_save_; }
    void take_back() { asks_load_ = asks_save_ = false; }

private:
    void draw_models(const HudContent& content, SurfaceEvents& events);
    void draw_worlds(const HudContent& content, SurfaceEvents& events);

    void show_lowest();

    bool wants_worlds_ = false;
    bool were_worlds_open_ = false;
    int frames_to_show_ = 0;  // pictures in which the menu still scrolls to what has just appeared
    std::array<char, 64> filter_{};
    std::string model_;  // selected; empty: none
    float scale_ = 1.0f;
    float mass_kg_ = 1.0f;
    bool is_fixed_ = false;
    bool is_compound_ = false;
    std::array<char, 64> world_name_{};
    std::string world_;       // selected; empty: none
    bool asks_load_ = false;  // waits for a second press
    bool asks_save_ = false;  // as asks_load_, over a saved world
};

}  // namespace atrium::viewer
