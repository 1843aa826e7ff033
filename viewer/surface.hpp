#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "viewer/controls.hpp"
#include "viewer/history.hpp"
#include "viewer/mouse_grab.hpp"
#include "viewer/people_view.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/scene_editor.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What the person in front of the screen wants.
struct SurfaceEvents {
    Motion motion;
    Pointer pointer;  // without a window: nothing is pressed
    bool close = false;
    bool screenshot = false;
    bool record = false;  // begin, or end, a video
    bool names = false;   // show people's, or hide them
    bool debug = false;   // show what is behind the picture, or hide it
    bool reset_view = false;
    bool follow = false;     // somebody, or nobody any more
    std::size_t person = 0;  // through whose eyes to look, from 1; 0: as before
    bool reset_scene = false;
    std::optional<NewThing> add;          // put that into the world, before the eye
    std::optional<std::uint32_t> remove;  // take that object out of it
    bool remove_pointed = false;          // and what the pointer is on
};

/// A thing of the world, to choose from a list.
struct ThingLine {
    std::uint32_t object = 0;
    std::string text;
};

/// What stands on the screen beside the picture.
struct HudFigures {
    double frames_per_s = 0.0;
    bus::LatencySummary capture_to_display;
    double bytes_per_s = 0.0;
    std::uint64_t num_skipped = 0;     // pairs that a newer one replaced, or that came too late
    std::uint64_t num_incomplete = 0;  // of which something was lost on the way
    std::uint64_t num_rejected = 0;
    std::vector<SiteLine> sites;
    std::vector<SiteLine> warnings;  // about sites and worlds, of their own reports
    std::vector<SiteLine> details;   // of how long they take for what
    std::size_t num_objects = 0;
    std::vector<ThingLine> things;        // in the order of their numbers
    std::optional<double> recording_s;    // of the video that is being recorded
    std::uint64_t num_video_dropped = 0;  // pictures that are missing in videos
    std::string quality;  // what is drawn, where the machine is too slow for all; empty: all is
    std::string notice;   // what just happened; empty: nothing
    std::array<float, History::kLength - 1> latency_ms{};  // of the last 30 s, see History
    std::array<float, History::kLength - 1> pictures_per_s{};
};

/// Where the picture goes: it owns the GL context, which is current on the thread that made it.
class Surface {
public:
    virtual ~Surface() = default;
    virtual std::string description() const = 0;
    virtual bool is_window() const = 0;
    /// Pictures per second that the display can show [Hz]; 0 where there is none.
    virtual double display_hz() const = 0;
    virtual std::array<int, 2> size() const = 0;  // of the picture [px]
    virtual SurfaceEvents poll() = 0;
    /// Returns when the picture is finished.
    virtual void show(const renderer::SceneRenderer& renderer, const HudFigures& figures) = 0;
    /// How long the last `show` waited, with a finished picture, for the display's turn.
    virtual std::chrono::steady_clock::duration waited_for_display() const = 0;
};

/// Who draws the pictures.
enum class ContextKind : std::uint8_t {
    kAuto,    // what can be had first of a window, a GPU without one, and OSMesa
    kWindow,  // and nothing else
    kEgl,     // without a window; in software where there is no GPU
    kOsmesa   // without a window, in software
};

struct SurfaceOptions {
    int width = 960;
    int height = 540;
    ContextKind context = ContextKind::kAuto;
    bool is_headless = false;      // no window even where there is a display
    bool wait_for_display = true;  // a window's vertical synchronisation
    bool has_two_buffers = false;  // a window's, one for each eye
};

/// A window. Error kUnavailable where there is no display or no OpenGL 3.3 on it. On the main
/// thread, one at a time.
Expected<std::unique_ptr<Surface>> open_window(const SurfaceOptions& options);

/// Pictures without a display; any thread. Has no buffers for two eyes. kAuto: on a GPU through
/// EGL, or with OSMesa where there is none, and the log says why.
Expected<std::unique_ptr<Surface>> open_headless(const SurfaceOptions& options);

/// What the options ask for; where a window cannot be had and need not be, what draws without one,
/// and the log says why.
Expected<std::unique_ptr<Surface>> open_surface(const SurfaceOptions& options);

}  // namespace atrium::viewer
