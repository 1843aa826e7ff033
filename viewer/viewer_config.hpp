#pragma once

#include "core/app/process.hpp"
#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"
#include "viewer/display.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/renderer/view_camera.hpp"
#include "viewer/surface.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

namespace atrium::viewer {

struct ViewConfig {
    std::string name;  // in ViewerStatus and SceneCommand; empty: viewer-<host>-<process id>-1
    int width = 960;
    int height = 540;
    double max_fps = 0.0;  // 0: 30 without a window, the display's rate with one
    std::string position_m = "2.6,-3.6,1.9";
    std::string target_m = "0,0,0.95";
    double fov_deg = 38.0;
    std::string antialias = "none";
    std::string names = "auto";    // auto: in a window
    std::string context = "auto";  // window, egl or osmesa: that one and no other
    std::string debug = "off";     // whether it begins with what is behind the picture
    std::string adapt = "auto";    // off: never draws less than asked for, however slow
    double scale = 1.0;            // of the picture's sides, at best
    std::string shadows = "on";
};

struct VideoConfig {
    std::filesystem::path file;  // empty: none
    double fps = 10.0;
    int width = 0;   // 0: as the view
    int height = 0;  // where one is 0 and the other is not, it follows from the view's shape
};

struct ViewerConfig {
    bus::BusOptions bus;
    app::ProcessOptions process{.nice = 2};  // capture, sites and world go first
    ViewConfig view;
    DisplayConfig display;
    VideoConfig video;
    bool headless = false;
    std::uint64_t frames = 0;  // 0: until stopped
    double seconds = 0.0;      // 0: until stopped
    std::uint64_t wait_people = 0;
    double wait_timeout_s = 30.0;
    std::filesystem::path output;  // the last picture; empty: none
    std::filesystem::path screenshot_dir = ".";
    std::filesystem::path models = "deploy/worlds";  // folder of the worlds' models
};

/// Declares every option, with its unit, on `set`.
void declare(ViewerConfig& config, config::OptionSet& set);

/// Error kConfiguration where the name of a file does not end as its format wants.
Expected<void> check_file_names(const ViewerConfig& config);

/// Width and height of a video of pictures of that size [px]: even, as its formats want.
std::pair<int, int> video_size(const VideoConfig& video, std::pair<int, int> picture);

/// "x,y,z" as three numbers; error kConfiguration names `key`.
Expected<Eigen::Vector3d> parse_point(const std::string& key, const std::string& text);

/// Who is to draw, and where to; an error where that has to be a window and may not.
Expected<SurfaceOptions> surface_options(const ViewerConfig& config);

/// The viewpoint that `config` describes; an error where it makes no sense.
Expected<renderer::ViewCamera> make_view_camera(const ViewConfig& config);

/// That no other viewer has, not even one of another host, or of this process.
std::string name_of_its_own();

}  // namespace atrium::viewer
