#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "core/recording/player.hpp"
#include "viewer/config/viewer_config.hpp"
#include "viewer/control/surface_events.hpp"
#include "viewer/control/world_editing.hpp"
#include "viewer/playback/thumbnails.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/scene/file_advice.hpp"
#include "viewer/scene/model_folder.hpp"
#include "viewer/scene/people_view.hpp"
#include "viewer/ui/history.hpp"

#include <Eigen/Geometry>

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// An object of the world as a list entry.
struct ObjectLine {
    std::uint32_t object = 0;
    std::string text;
};

/// A site as a list entry.
struct SiteLine {
    std::string name;
    std::size_t number = 0;  // of its person, for the keys 1 to 9; 0: nobody is there
    std::string rate;        // of meshes shown and of metaframes that the site publishes
    std::string state;
    bool is_warning = false;  // the state needs attention
    bool is_shown = true;
    bool is_solo = false;
};

/// A numbered viewpoint as a list entry.
struct ViewpointLine {
    int number = 0;
    std::string name;
    bool is_own = false;  // the user's, not of the viewer file
};

/// A recording that is shown, for its timeline.
struct TimelineContent {
    recording::PlayState state;
    Timestamp recorded;                      // the moment shown, when it was recorded
    const Thumbnails* thumbnails = nullptr;  // null: none
};

/// Statistics and messages shown beside the picture.
struct HudContent {
    double frames_per_s = 0.0;
    bus::LatencySummary capture_to_display;
    double bytes_per_s = 0.0;
    std::uint64_t num_skipped = 0;     // pairs replaced by a newer one, or too late
    std::uint64_t num_incomplete = 0;  // pairs with lost samples
    std::uint64_t num_rejected = 0;
    std::string world;
    std::vector<SiteLine> sites;         // by name
    std::vector<std::string> preparing;  // sites that are present and have published nothing yet
    std::vector<ViewpointLine> viewpoints;
    bool has_other_worlds = false;  // the user may go back to the list of worlds
    bus::OtherWorlds other_worlds;
    std::string inside;             // person through whose eyes the user looks; empty: nobody
    std::string followed;           // person that the viewpoint follows; empty: nobody
    std::vector<HudLine> warnings;  // from the status reports of sites and worlds
    std::vector<HudLine> details;   // stage times from the status reports
    BadFiles bad_files;             // of the world
    std::size_t num_objects = 0;
    std::vector<ObjectLine> objects;  // ordered by number
    EditView edit;
    ModelFolder::List models;  // null: not read yet
    std::string models_folder;
    std::string measured_model;           // file of `model_size`
    std::optional<ModelSize> model_size;  // none: not measured yet
    std::string left;                     // sites whose people have just left; empty: none
    std::optional<double> recording_s;    // length of the running video
    double video_fps = 0.0;               // its pictures per second
    std::uint64_t num_video_dropped = 0;  // pictures missing in videos and streams
    std::string live;                     // stream and virtual camera; empty: none
    std::string quality;                  // reduced quality on a slow machine; empty: full quality
    std::optional<TimelineContent> timeline;  // none: the world is alive
    std::string notice;                       // message about the last event; empty: none
    std::vector<Eigen::AlignedBox2f> names;   // labels in the picture, as shares of it
    std::array<float, History::kLength - 1> latency_ms{};  // last 30 s, see History
    std::array<float, History::kLength - 1> pictures_per_s{};
};

/// Title of a window that shows no world.
inline constexpr const char* kWindowTitle = "Atrium";

/// Target of the picture. Owns the GL context, which is current on the thread that created it.
class Surface {
public:
    virtual ~Surface() = default;
    virtual std::string description() const = 0;
    virtual bool is_window() const = 0;
    /// Refresh rate of the display [Hz]. 0 without a display.
    virtual double display_hz() const = 0;
    virtual std::array<int, 2> size() const = 0;  // size of the picture [px]
    virtual SurfaceEvents poll() = 0;
    /// Shows the picture. Returns when drawing has finished.
    virtual void show(const renderer::SceneRenderer& renderer, const HudContent& content) = 0;
    /// Shows only what `layout` lays out with ImGui. Does nothing without a window.
    virtual void show_layout(const std::function<void()>& layout) = 0;
    /// UTF-8. Does nothing without a window.
    virtual void set_title(const std::string& title) = 0;
    /// Content scale of the display: 2 where its settings ask for letters of twice the size.
    virtual double content_scale() const = 0;
    /// Time that the last `show` waited for the display after drawing had finished.
    virtual std::chrono::steady_clock::duration waited_for_display() const = 0;
};

/// Kind of GL context.
enum class ContextKind : std::uint8_t {
    kAuto,    // first available of: window, GPU without a window, OSMesa
    kWindow,  // window only
    kEgl,     // EGL without a window; in software if there is no GPU
    kOsmesa   // OSMesa: in software, without a window
};

struct SurfaceOptions {
    int width = 960;
    int height = 540;
    ContextKind context = ContextKind::kAuto;
    bool is_headless = false;      // no window even if there is a display
    bool wait_for_display = true;  // vertical synchronisation of a window
    bool has_two_buffers = false;  // stereo window with one buffer per eye
    double ui_scale = 0.0;         // of panels, see ui_scale_of; 0: automatic
};

/// Surface options of the configuration. Error kConfiguration if it needs a window and rules one
/// out.
Expected<SurfaceOptions> surface_options(const ViewerConfig& config);

/// Opens a window. Error kUnavailable if there is no display or it lacks OpenGL 3.3. Main thread
/// only, one window at a time.
Expected<std::unique_ptr<Surface>> open_window(const SurfaceOptions& options);

/// Opens a context without a display. Any thread. No stereo buffers. kAuto: EGL on a GPU, or OSMesa
/// if there is none; the log gives the reason.
Expected<std::unique_ptr<Surface>> open_headless(const SurfaceOptions& options);

/// Opens the surface that the options ask for. Falls back to one without a window if a window is
/// unavailable and not required; the log gives the reason.
Expected<std::unique_ptr<Surface>> open_surface(const SurfaceOptions& options);

}  // namespace atrium::viewer
