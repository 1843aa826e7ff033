#pragma once

#include "viewer/ui/surface.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace atrium::viewer {

/// The timeline of a recording along the lower edge of the picture: thumbnails, a slider to scrub,
/// marks, play, pause, steps, speed, loop. Needs the window's GL context.
class TimelinePanel {
public:
    /// Lays it out and writes the user's choices to `events`. Inside an ImGui frame.
    void draw(const TimelineContent& content, SurfaceEvents& events);
    /// Height of the panel with the margin below it, in the last picture [px]; 0: not shown yet.
    float height_px() const { return height_px_; }

private:
    void draw_strip(const TimelineContent& content, SurfaceEvents& events);
    void draw_buttons(const TimelineContent& content, SurfaceEvents& events);
    void load_thumbnails(const TimelineContent& content);

    float height_px_ = 0.0f;
    std::size_t loaded_revision_ = 0;
    std::array<std::uint32_t, Thumbnails::kNum> textures_{};  // GL's names; 0: none. The context
                                                              // frees them
};

}  // namespace atrium::viewer
