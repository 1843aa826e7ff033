#include "viewer/config/viewer_config.hpp"

#include "core/app/process.hpp"
#include "core/bus/bus_options.hpp"
#include "core/bus/names.hpp"
#include "core/presence/membership.hpp"
#include "viewer/config/stream_address.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <system_error>

namespace atrium::viewer {

namespace {

void declare(ViewConfig& view, config::OptionSet& set) {
    set.add("view.name",
            view.name,
            "name in status and commands, of A-Z a-z 0-9 _ . -; empty: a unique name");
    set.add("view.width", view.width, "width of the picture [px]", {.min = 16, .max = 8192});
    set.add("view.height", view.height, "height of the picture [px]", {.min = 16, .max = 8192});
    set.add("view.max_fps",
            view.max_fps,
            "pictures per second [Hz]; 0: 30 without a window, else the display's rate",
            {.min = 0, .max = 1000});
    set.add("view.position_m",
            view.position_m,
            fmt::format("position of the eye in the world, \"x,y,z\" [m]; empty: {}, or if "
                        "view.target_m is empty too, one that shows the first people",
                        ViewConfig::kUsualPosition));
    set.add("view.target_m",
            view.target_m,
            fmt::format("point that the eye looks at, \"x,y,z\" [m]; empty: {}, or as "
                        "view.position_m",
                        ViewConfig::kUsualTarget));
    set.add(
        "view.fov_deg", view.fov_deg, "vertical opening angle [degrees]", {.min = 5, .max = 150});
    set.add("view.antialias",
            view.antialias,
            "anti-aliasing; fxaa costs about 12 ms of one core per picture in software",
            {"none", "fxaa"});
    set.add("view.outlines",
            view.outlines,
            "outlines of people; soft: what the nearest cameras saw a little beyond the hull shows "
            "too; hull: as the hull has them",
            {"soft", "hull"});
    set.add("view.names",
            view.names,
            "names over the heads of people; auto: only in a window",
            {"auto", "on", "off"});
    set.add("view.context",
            view.context,
            "GL context; auto: a window, else a GPU through EGL, else OSMesa in software; egl and "
            "osmesa: without a window",
            {"auto", "window", "egl", "osmesa"});
    set.add("view.debug",
            view.debug,
            "debug view: wireframe, cameras, silhouettes, collision shapes (B in a window)",
            {"off", "on"});
    set.add("view.adapt",
            view.adapt,
            "what a slow machine reduces; auto: drawing rate, then resolution, then shadows; off: "
            "nothing, pictures come late and unevenly",
            {"auto", "off"});
    set.add(
        "view.scale",
        view.scale,
        "maximum resolution of the scene, as a share of the picture's; scaled up to the picture",
        {.min = 0.1, .max = 1});
    set.add("view.shadows", view.shadows, "shadows; view.adapt may switch them off", {"on", "off"});
    set.add(
        "view.ui_scale",
        view.ui_scale,
        "size of panels and names, 1: for 1280x720; 0: from the picture's height and the display",
        {.min = 0, .max = 8});
}

void declare(DisplayConfig& display, config::OptionSet& set) {
    set.add("display.stereo",
            display.stereo,
            "stereo mode; quad_buffer needs a window and a driver that supports it",
            {"none", "side_by_side", "top_bottom", "anaglyph", "quad_buffer"});
    set.add("display.eye_distance_m",
            display.eye_distance_m,
            "distance between the eyes [m]",
            {.min = 0, .max = 1});
    set.add("display.convergence_m",
            display.convergence_m,
            "distance of zero parallax [m]; 0: distance of the target",
            {.min = 0, .max = 100});
    set.add(
        "display.wall", display.wall, "TOML file that describes a wall of projectors; empty: none");
    set.add("display.tile", display.tile, "tile of the wall that this viewer draws");
    set.add("display.delay_ms",
            display.delay_ms,
            "playback delay of a wall, so all tiles show the same moment [ms]",
            {.min = 0, .max = 500});
}

}  // namespace

std::filesystem::path usual_models() {
    const std::filesystem::path above = app::program_folder().parent_path();
    const std::filesystem::path installed = above / "deploy" / "worlds";
    std::error_code ignored;
    return std::filesystem::is_directory(installed, ignored)
               ? installed
               : above.parent_path() / "deploy" / "worlds";
}

void declare(ViewerConfig& config, config::OptionSet& set) {
    bus::declare(config.bus, set);
    app::declare(config.process, set);
    declare(config.view, set);
    declare(config.display, set);
    set.add("recording.file",
            config.recording.file,
            "recording (.mcap) to show instead of a living world; also without the option's name");
    set.add_alias("recording");
    set.add("recording.path",
            config.recording.path,
            "camera path (JSON) of the video; a window adds the keys of U to it; empty: "
            "FILE.path.json beside the recording for these, and none for a video");
    set.add_alias("path");
    set.add("recording.from", config.recording.from_s, "begin here [s]", {.min = 0, .max = 1e9});
    set.add("recording.to",
            config.recording.to_s,
            "end here [s]; 0: at the end",
            {.min = 0, .max = 1e9});
    set.add("recording.loop", config.recording.loop, "begin again at the end");
    set.add("recording.paused", config.recording.paused, "show the first moment and wait");
    set.add("headless", config.headless, "draw without a window even if there is a display");
    set.add("frames", config.frames, "stop after this many pictures; 0: no limit");
    set.add(
        "seconds", config.seconds, "stop after this time [s]; 0: no limit", {.min = 0, .max = 1e9});
    set.add("wait_people",
            config.wait_people,
            "start to count `frames` and `seconds` when this many people are shown");
    set.add("wait_timeout_s",
            config.wait_timeout_s,
            "fail if they are not shown after this time [s]",
            {.min = 0, .max = 1e9});
    set.add("output", config.output, "PNG file for the last picture; empty: none");
    set.add("screenshot_dir",
            config.screenshot_dir,
            "folder for screenshots (F12 or P) and videos (F9); default: the current one");
    set.add(
        "viewer.models",
        config.models,
        "local folder of the models that worlds name; default: deploy/worlds of this installation");
    set.add("video.file", config.video.file, "video to write: .avi, .mp4 or .mkv; empty: none");
    set.add("video.fps",
            config.video.fps,
            "pictures per second of the video, stream and virtual camera [Hz]",
            {.min = 0.1, .max = 120});
    set.add("video.width",
            config.video.width,
            "width of the video [px]; 0: from the view, or from its height",
            {.min = 0, .max = 8192});
    set.add("video.height",
            config.video.height,
            "height of the video [px]; 0: from the view, or from its width",
            {.min = 0, .max = 8192});
    set.add("video.stream",
            config.video.stream,
            "address of a receiver such as OBS: srt://host:port?mode=caller|listener, "
            "tcp://host:port, udp://host:port, rtmp://host/app/key; empty: none");
    set.add("video.stream_kbps",
            config.video.stream_kbps,
            "bit rate of the stream [kbit/s]; 0: by its size and rate",
            {.min = 0, .max = 200'000});
    set.add("video.supersample",
            config.video.supersample,
            "of a recording: draw each pixel of the video from so many each way",
            {.min = 1, .max = 4});
    set.add(
        "video.virtual_camera",
        config.video.virtual_camera,
        "device of v4l2loopback (/dev/videoN) that other programs see as a camera; empty: none");
}

Expected<void> check_names(const ViewerConfig& config) {
    if (!config.view.name.empty() && !bus::is_valid_name(config.view.name)) {
        return make_error(ErrorKind::kConfiguration,
                          "view.name: must be 1 to 63 characters of A-Z a-z 0-9 _ . -, got '" +
                              config.view.name + "'");
    }
    const std::filesystem::path& output = config.output;
    if (!output.empty() && output.extension() != ".png") {
        return make_error(ErrorKind::kConfiguration,
                          "output: must end in .png, got '" + output.string() + "'");
    }
    const std::filesystem::path& video = config.video.file;
    const std::string format = video.extension().string();
    if (!video.empty() && format != ".avi" && format != ".mkv" && format != ".mp4") {
        return make_error(
            ErrorKind::kConfiguration,
            "video.file: must end in .avi, .mkv or .mp4, got '" + video.string() + "'");
    }
    if (!config.video.stream.empty()) {
        if (const auto target = parse_stream(config.video.stream); !target)
            return tl::unexpected(target.error());
    }
    return {};
}

Expected<void> check_recording(const ViewerConfig& config) {
    const std::filesystem::path& file = config.recording.file;
    const auto wrong = [](const std::string& what) {
        return make_error(ErrorKind::kConfiguration, what);
    };
    if (file.empty()) {
        if (!config.recording.path.empty())
            return wrong("recording.path: a camera path belongs to a recording: viewer FILE.mcap");
        return {};
    }
    if (std::error_code failure; std::filesystem::is_directory(file, failure))
        return wrong(
            fmt::format("{} is a folder: a recording of a room is played by site_node "
                        "--recording, and a viewer shows recordings of worlds (.mcap)",
                        file.string()));
    if (file.extension() != ".mcap") {
        const std::string name = file.string();
        return wrong(fmt::format("unexpected: {}; {}",
                                 name,
                                 file.extension() == ".toml"
                                     ? "a file is given as --config " + name
                                     : "a recording ends in .mcap, and a world is given as "
                                       "--world " +
                                           name));
    }
    if (!config.video.file.empty() && !config.output.empty())
        return wrong(
            "output: not with a film (video.file) of a recording; make the picture in a "
            "run of its own");
    if (config.recording.to_s > 0.0 && config.recording.to_s <= config.recording.from_s)
        return wrong(fmt::format("recording.to: must be later than recording.from ({:g})",
                                 config.recording.from_s));
    if (!config.display.wall.empty())
        return wrong(
            "display.wall: a wall shows a living world; play the recording into one with "
            "atrium play");
    return {};
}

std::pair<int, int> video_size(const VideoConfig& video, std::pair<int, int> picture) {
    const double width = picture.first;
    const double height = picture.second;
    const double scale = video.width > 0    ? video.width / width
                         : video.height > 0 ? video.height / height
                                            : 1.0;
    const auto even = [](double size) {
        return std::max(2, static_cast<int>(std::lround(size)) / 2 * 2);
    };
    return {even(video.width > 0 ? video.width : scale * width),
            even(video.height > 0 ? video.height : scale * height)};
}

Expected<Eigen::Vector3d> parse_point(const std::string& key, const std::string& text) {
    std::istringstream in(text);
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    char comma1 = 0;
    char comma2 = 0;
    in >> p.x() >> comma1 >> p.y() >> comma2 >> p.z();
    const bool is_read = static_cast<bool>(in) && comma1 == ',' && comma2 == ',' && p.allFinite();
    if (!is_read || !(in >> std::ws).eof()) {
        return make_error(
            ErrorKind::kConfiguration,
            key + ": expected three numbers \"x,y,z\" in metres, got \"" + text + "\"");
    }
    return p;
}

Expected<renderer::ViewCamera> make_view_camera(const ViewConfig& config) {
    const auto position =
        parse_point("view.position_m",
                    config.position_m.empty() ? ViewConfig::kUsualPosition : config.position_m);
    if (!position) return tl::unexpected(position.error());
    const auto target = parse_point(
        "view.target_m", config.target_m.empty() ? ViewConfig::kUsualTarget : config.target_m);
    if (!target) return tl::unexpected(target.error());
    if ((*position - *target).norm() < 1e-3) {
        return make_error(ErrorKind::kConfiguration,
                          "view.target_m: must differ from view.position_m");
    }
    return renderer::ViewCamera{
        .position_m = *position, .target_m = *target, .fov_deg = config.fov_deg};
}

std::string make_unique_name() {
    static std::atomic<int> num_named{0};
    const std::string end = fmt::format("-{}-{}", getpid(), ++num_named);
    const std::string host = presence::host_name();
    return "viewer-" + host.substr(0, 63 - std::min<std::size_t>(63, 7 + end.size())) + end;
}

}  // namespace atrium::viewer
