#pragma once

#include "core/app/process.hpp"
#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"
#include "viewer/config/viewpoints.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

struct ViewConfig {
    static constexpr const char* kUsualPosition = "2.6,-3.6,1.9";
    static constexpr const char* kUsualTarget = "0,0,0.95";

    /// In ViewerStatus and SceneCommand; empty: viewer-<host>-<process id>-<number>.
    std::string name;
    int width = 960;
    int height = 540;
    double max_fps = 0.0;    // 0: 30 without a window, else the display's rate
    std::string position_m;  // this and `target_m` empty: the viewer frames the first people
    std::string target_m;
    double fov_deg = 38.0;
    std::string antialias = "none";
    std::string outlines = "soft";  // of people
    std::string names = "auto";     // auto: only in a window
    std::string context = "auto";   // window, egl, osmesa: only that one
    std::string debug = "off";      // on: starts with the debug view
    std::string adapt = "auto";     // off: never reduces the quality
    double scale = 1.0;             // maximum share of the picture's width and height
    std::string shadows = "on";
    double ui_scale = 0.0;  // of panels and names; 0: automatic
};

struct DisplayConfig {
    std::string stereo = "none";
    double eye_distance_m = 0.064;
    double convergence_m = 0.0;    // 0: distance of the target
    std::filesystem::path wall{};  // empty: a single display
    std::string tile{};
    double delay_ms = 120.0;
};

struct VideoConfig {
    std::filesystem::path file;  // empty: none
    double fps = 30.0;
    int width = 0;         // 0: as the view
    int height = 0;        // if only one is 0, it follows from the view's aspect ratio
    std::string stream{};  // address of a receiver; empty: none
    int stream_kbps = 0;   // 0: by size and rate
    std::filesystem::path virtual_camera{};  // V4L2 output device; empty: none
    int supersample = 1;  // of a recording: pixels drawn per pixel of the video, each way
};

/// A recording that is shown instead of a living world.
struct RecordingConfig {
    std::filesystem::path file{};  // empty: a living world
    std::filesystem::path path{};  // camera path; empty: FILE.path.json for keys, none for a film
    double from_s = 0.0;
    double to_s = 0.0;  // 0: the end
    bool loop = false;
    bool paused = false;
};

/// The folder of the delivered worlds, beside the folder of this program: in the repository, of
/// which the program lies in a build folder, or where it was installed with its folder deploy.
std::filesystem::path usual_models();

struct ViewerConfig {
    bus::BusOptions bus;
    app::ProcessOptions process{.nice = 2};  // capture, sites and world have priority
    ViewConfig view;
    DisplayConfig display;
    VideoConfig video;
    RecordingConfig recording;
    bool headless = false;
    std::uint64_t frames = 0;  // 0: until stopped
    double seconds = 0.0;      // 0: until stopped
    std::uint64_t wait_people = 0;
    double wait_timeout_s = 30.0;
    std::filesystem::path output;  // file of the last picture; empty: none
    std::filesystem::path screenshot_dir = ".";
    std::filesystem::path models = usual_models();  // folder of the worlds' models
    std::vector<Viewpoint> viewpoints;              // numbered from 1; only a file can set them
    bool has_other_worlds = false;         // the user may leave the world for the list of worlds
    std::filesystem::path viewpoint_file;  // of the user; empty: kept until the end
};

/// Declares every option, with its unit, on `set`.
void declare(ViewerConfig& config, config::OptionSet& set);

/// Checks the name, the extensions of the output files and the address of the stream. Error
/// kConfiguration if one does not match its format.
Expected<void> check_names(const ViewerConfig& config);

/// Checks the options of a recording together. Error kConfiguration.
Expected<void> check_recording(const ViewerConfig& config);

/// Size of the video for pictures of that size [px]. Even, as the formats require.
std::pair<int, int> video_size(const VideoConfig& video, std::pair<int, int> picture);

/// Parses "x,y,z". Error kConfiguration names `key`.
Expected<Eigen::Vector3d> parse_point(const std::string& key, const std::string& text);

/// Whether the user chose the viewpoint of the start.
inline bool has_view(const ViewConfig& config) {
    return !config.position_m.empty() || !config.target_m.empty();
}

/// Viewpoint of the configuration. Error kConfiguration if it is invalid.
Expected<renderer::ViewCamera> make_view_camera(const ViewConfig& config);

/// Returns a name that is unique across hosts, processes and the viewers of this process.
std::string make_unique_name();

}  // namespace atrium::viewer
