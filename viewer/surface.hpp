#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "viewer/controls.hpp"
#include "viewer/mouse_grab.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What the person in front of the screen wants.
struct SurfaceEvents {
    Motion motion;
    Pointer pointer;  // without a window: nothing is pressed
    bool close = false;
    bool screenshot = false;
    bool reset_view = false;
    bool reset_scene = false;
};

/// What stands on the screen beside the picture.
struct HudFigures {
    double frames_per_s = 0.0;
    bus::LatencySummary capture_to_display;
    std::vector<std::string> sites;  // one line each
    std::size_t num_objects = 0;
};

/// Where the picture goes: it owns the GL context, which is current on the thread that made it.
class Surface {
public:
    virtual ~Surface() = default;
    virtual std::string description() const = 0;
    /// Pictures per second that the display can show [Hz]; 0 where there is none.
    virtual double display_hz() const = 0;
    virtual std::array<int, 2> size() const = 0;  // of the picture [px]
    virtual SurfaceEvents poll() = 0;
    /// Returns when the picture is finished.
    virtual void show(const renderer::SceneRenderer& renderer, const HudFigures& figures) = 0;
};

struct SurfaceOptions {
    int width = 960;
    int height = 540;
    bool wait_for_display = true;  // a window's vertical synchronisation
    bool has_two_buffers = false;  // a window's, one for each eye
};

/// A window. Error kUnavailable where there is no display or no OpenGL 3.3 on it. On the main
/// thread, one at a time.
Expected<std::unique_ptr<Surface>> open_window(const SurfaceOptions& options);

/// Software rendering without a display; any thread. Has no buffers for two eyes.
Expected<std::unique_ptr<Surface>> open_headless(const SurfaceOptions& options);

/// A window, or software rendering where it cannot be had, which is logged.
Expected<std::unique_ptr<Surface>> open_surface(const SurfaceOptions& options);

}  // namespace atrium::viewer
