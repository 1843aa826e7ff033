#pragma once

#include "viewer/ui/surface.hpp"

#include <array>

namespace atrium::viewer {

/// The list of numbered viewpoints: goes to them, names, keeps and forgets them.
class ViewpointPanel {
public:
    /// Lays out the list and writes the user's choices to `events`. Inside an ImGui frame.
    void draw(const HudContent& content, SurfaceEvents& events);

private:
    void draw_line(const ViewpointLine& line, SurfaceEvents& events);

    int renamed_ = 0;           // number of the viewpoint whose name is typed; 0: none
    int deleted_ = 0;           // number of the viewpoint that the next press deletes; 0: none
    bool wants_focus_ = false;  // the field of that name just appeared
    std::array<char, 64> name_{};
};

}  // namespace atrium::viewer
