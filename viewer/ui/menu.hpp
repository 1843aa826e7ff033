#pragma once

#include "viewer/ui/edit_panel.hpp"
#include "viewer/ui/surface.hpp"

#include <array>
#include <cstdint>

namespace atrium::viewer {

/// The menu that adds, removes and resets objects, for mouse and keyboard.
class Menu {
public:
    /// Lays out the menu and writes the user's choices to `events`. Call between ImGui's NewFrame
    /// and Render.
    void draw(const HudContent& content, SurfaceEvents& events);

    /// Width that it wants [px]. Inside an ImGui frame.
    static float width();
    /// Opens the list of saved worlds.
    void show_worlds() { worlds_.show_worlds(); }

    /// Whether a button waits for a second press.
    bool asks() const { return asks_reset_ || worlds_.asks(); }
    void take_back() {
        asks_reset_ = false;
        worlds_.take_back();
    }

private:
    void draw_new_object(SurfaceEvents& events);
    void draw_object_list(const HudContent& content, SurfaceEvents& events);

    int shape_ = 0;                                     // index into the menu's shapes
    std::array<float, 3> size_m_{0.25f, 0.25f, 0.25f};  // as NewObject::size_m
    float mass_kg_ = 0.5f;
    std::array<float, 3> colour_{0.85f, 0.35f, 0.15f};  // sRGB
    std::array<char, 64> name_{};
    WorldPanel worlds_;
    std::uint32_t chosen_ = 0;  // selected object; 0: none
    bool asks_reset_ = false;   // waits for a second press
};

}  // namespace atrium::viewer
