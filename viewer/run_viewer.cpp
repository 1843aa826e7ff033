#include "viewer/run_viewer.hpp"

#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/base/looked_up.hpp"
#include "core/config/spelling.hpp"
#include "viewer/config/user_files.hpp"
#include "viewer/film/film.hpp"
#include "viewer/record/output_files.hpp"
#include "viewer/start/choose_world.hpp"
#include "viewer/start/recent_worlds.hpp"
#include "viewer/viewer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr std::chrono::milliseconds kListen{2500};
constexpr int kExitNothingHeard = 3;  // something required is missing

// Whether the run can go on and end without a user.
bool is_unattended(const ViewerConfig& config) {
    return config.headless || config.frames > 0 || config.seconds > 0.0 || config.wait_people > 0 ||
           !config.output.empty() || !config.video.file.empty() || !config.display.wall.empty() ||
           config.view.context == "egl" || config.view.context == "osmesa";
}

std::filesystem::path user_file(const char* name) {
    const auto folder = user_folder();
    return folder ? *folder / name : std::filesystem::path();
}

// Of a run that ends with this world.
int run_once(const ViewerConfig& config, std::stop_token stop) {
    auto viewer = Viewer::create(config, stop, Viewer::SurfaceIs::kOpenedNow);
    if (!viewer) return stop.stop_requested() ? 0 : app::fail(viewer.error());
    if (auto done = (*viewer)->run(stop); !done) return app::fail(done.error());
    return 0;
}

int print_worlds(const ViewerConfig& config, const Error& no_window, std::stop_token stop) {
    fmt::print("No window ({}) and no world given.\n", no_window.message);
    std::fflush(stdout);
    const auto report = report_worlds(config.bus, kListen, stop);
    if (!report) return app::fail(report.error());
    fmt::print("{}", report->text);
    return report->has_worlds ? 0 : kExitNothingHeard;
}

// A user at a window, who may visit several worlds.
class Visit {
public:
    Visit(ViewerConfig config, std::stop_token stop)
        : config_(std::move(config)),
          stop_(std::move(stop)),
          recent_(user_file("recent_worlds.toml")) {}

    int run() {
        while (!stop_.stop_requested()) {
            const bool is_chosen = config_.bus.world.empty();
            if (is_chosen) {
                if (const auto exit = choose()) return *exit;
            }
            if (const auto exit = visit(is_chosen)) return *exit;
            config_.bus.world.clear();
        }
        return 0;
    }

private:
    // Returns the exit code if the program ends.
    std::optional<int> choose() {
        if (!surface_) {
            const auto options = surface_options(config_);
            if (!options) return app::fail(options.error());
            auto opened = open_window(*options);
            if (!opened && config_.view.context == "window") return app::fail(opened.error());
            if (!opened) return print_worlds(config_, opened.error(), stop_);
            surface_ = std::move(*opened);
        }
        const auto world =
            choose_world(*surface_, config_.bus, recent_, std::exchange(notice_, ""), stop_);
        if (!world) return 0;
        config_.bus = *world;
        app::log::info("world_chosen world={} domain={} network={}",
                       world->world,
                       world->domain,
                       world->network);
        return std::nullopt;
    }

    std::optional<int> visit(bool is_chosen) {
        auto viewer =
            Viewer::create(config_, stop_, Viewer::SurfaceIs::kOpenedNow, std::move(surface_));
        if (!viewer) {
            if (stop_.stop_requested()) return 0;
            if (!is_chosen) return app::fail(viewer.error());
            notice_ = fmt::format("{}: {}", config_.bus.world, viewer.error().message);
            app::log::warn(
                "join_failed world={} reason=\"{}\"", config_.bus.world, viewer.error().message);
            return std::nullopt;
        }
        const bool has_window = (*viewer)->has_window();
        const auto done = (*viewer)->run(stop_);
        // a mistyped world would stay in the list
        if (has_window && (*viewer)->has_met_others()) {
            if (const auto kept = recent_.add(config_.bus); !kept)
                app::log::warn("recent_worlds_failed reason=\"{}\"", kept.error().message);
        }
        if (!done) return app::fail(done.error());
        surface_ = (*viewer)->take_surface();
        return surface_ ? std::nullopt : std::optional<int>(0);
    }

    ViewerConfig config_;
    std::stop_token stop_;
    RecentWorlds recent_;
    std::string notice_;
    std::unique_ptr<Surface> surface_;
};

// A folder of models that is not there or closed to this user. The default one may be missing,
// which is logged.
Expected<void> check_models(const ViewerConfig& config) {
    std::error_code failure;
    const bool is_default = config.models == ViewerConfig().models;
    if (std::filesystem::is_directory(config.models, failure)) {
        if (access(config.models.c_str(), R_OK | X_OK) == 0) return {};
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("viewer.models: this user may not look into {}; run `chmod "
                                      "a+rx` on it",
                                      config.models.string()));
    }
    if (is_default) {
        app::log::warn(
            "models_folder_missing folder={}; objects with models are drawn as boxes; give the "
            "folder of the world's models and textures with --viewer.models FOLDER",
            config.models.string());
        return {};
    }
    const std::string meant = config::ask_which_path(config.models);
    return make_error(ErrorKind::kNotFound,
                      fmt::format("viewer.models: {} is no folder{}{}",
                                  config.models.string(),
                                  looked_up_from(config.models),
                                  meant.empty() ? "" : "; " + meant));
}

}  // namespace

int run_viewer(ViewerConfig config, std::stop_token stop) {
    if (const auto ready = check_outputs(config); !ready) return app::fail(ready.error());
    if (const auto found = check_models(config); !found) return app::fail(found.error());
    config.viewpoint_file = user_file("viewpoints.toml");
    if (!config.recording.file.empty()) {
        if (config.video.file.empty()) return run_once(config, stop);
        const auto rendered = render_film(config, stop);
        return rendered ? 0 : app::fail(rendered.error());
    }
    if (is_unattended(config)) {
        if (config.bus.world.empty()) config.bus.world = bus::BusOptions().world;
        return run_once(config, stop);
    }
    // keys are of one world
    if (config.bus.keys) return run_once(config, stop);
    config.has_other_worlds = true;
    return Visit(std::move(config), stop).run();
}

}  // namespace atrium::viewer
