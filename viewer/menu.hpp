#pragma once

#include "viewer/surface.hpp"

#include <array>
#include <cstdint>

namespace atrium::viewer {

/// The menu: puts things into the world, takes them out, resets them. For mouse and keyboard.
class Menu {
public:
    /// Lays it out, and says in `events` what was chosen. Between ImGui's NewFrame and Render.
    void draw(const HudFigures& figures, SurfaceEvents& events);

private:
    void draw_new_thing(SurfaceEvents& events);
    void draw_things(const HudFigures& figures, SurfaceEvents& events);

    int shape_ = 0;                                     // index into the menu's shapes
    std::array<float, 3> size_m_{0.25f, 0.25f, 0.25f};  // as NewThing's
    float mass_kg_ = 0.5f;
    std::array<float, 3> colour_{0.85f, 0.35f, 0.15f};  // as it is seen (sRGB)
    std::array<char, 64> name_{};
    std::uint32_t chosen_ = 0;  // object; 0: none
};

}  // namespace atrium::viewer
