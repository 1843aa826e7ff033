#include "tools/simulated_cameras/program.hpp"

#include "core/app/log.hpp"
#include "core/app/private_network.hpp"
#include "core/base/thread_pool.hpp"
#include "simulation/model.hpp"
#include "site_node/rig_check/rig_geometry.hpp"
#include "tools/simulated_cameras/camera_server.hpp"
#include "tools/simulated_cameras/command.hpp"
#include "tools/simulated_cameras/sensor.hpp"
#include "tools/simulated_cameras/write_recording.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <thread>

namespace atrium::simulated_cameras {
namespace {

// Limit of Aravis' fake camera.
constexpr int kMaxSidePx = 2048;
// Loopback addresses; the first is the host's.
constexpr std::size_t kMaxCameras = 64;

Expected<void> check(const config::Rig& rig) {
    if (rig.cameras.size() > kMaxCameras) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format(
                "rig: at most {} cameras can be served, got {}", kMaxCameras, rig.cameras.size()));
    }
    for (const geometry::CalibratedCamera& camera : rig.cameras) {
        const geometry::PinholeCamera& c = camera.intrinsics;
        if (c.width > kMaxSidePx || c.height > kMaxSidePx) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("rig: camera {}: must be at most {} px wide and high",
                                          camera.name,
                                          kMaxSidePx));
        }
    }
    return {};
}

// Only warnings: cameras of which no hull is possible can be served as well.
void warn_about(const config::Rig& rig, const std::filesystem::path& file) {
    for (const rig_check::Finding& finding : rig_check::check_rig(rig.cameras, rig.unit_m))
        app::log::warn("rig_looks_wrong file={} reason=\"{}\"", file.string(), finding.text);
}

Expected<ShownPictures> load_pictures(const Plan& plan, std::stop_token stop) {
    if (!plan.config.recording.empty())
        return show_recording(plan.config.recording, plan.format, stop);
    const simulation::RoomConfig& room = plan.config.simulation;
    if (room.shows == "person" && !room.model.empty()) {
        const auto model =
            simulation::examine_model(simulation::room_options(room, plan.rig.rate_hz));
        if (!model) return tl::unexpected(model.error());
        app::log::info("model file={} {}", room.model.string(), simulation::describe(*model));
        for (const std::string& warning : model->warnings)
            app::log::warn("model file={} {}", room.model.string(), warning);
    }
    std::size_t last_step = 0;
    const auto report = [&](std::size_t done, std::size_t total) {
        if (total == 0) return app::log::info("another program renders this room: waiting for it");
        const std::size_t step = done * 20 / total;
        if (step != last_step) app::log::info("rendering the simulated room {} %", step * 5);
        last_step = step;
    };
    return show_room(plan.rig, room, plan.format, report, stop);
}

// What a private network hides.
std::string network_notice(const std::vector<std::string>& command, int process) {
    if (command.empty()) {
        return fmt::format(
            "no command given; to enter the network: nsenter --preserve-credentials -U -n -t {}",
            process);
    }
    return "network: the command sees only these cameras, and no program outside sees the command; "
           "to show its people in a world, start world_server and viewer inside, too: one script "
           "after -- that starts all three";
}

// Requests a stop after this time, unless one was requested before.
std::jthread time_limit(double seconds, std::stop_source& stop) {
    return std::jthread([seconds, &stop](std::stop_token ended) {
        std::mutex mutex;
        std::condition_variable_any wake;
        std::unique_lock lock(mutex);
        wake.wait_for(lock, ended, std::chrono::duration<double>(seconds), [] { return false; });
        if (!ended.stop_requested()) stop.request_stop();
    });
}

}  // namespace

Expected<Plan> make_plan(const SimulatedCamerasConfig& config, std::vector<std::string> command) {
    if (auto checked = check(config); !checked) return tl::unexpected(checked.error());
    if (!config.write_recording.empty() && !command.empty())
        return make_error(ErrorKind::kConfiguration,
                          "write_recording: serves no cameras, so it runs no command: leave out "
                          "what is after --");
    Plan plan{
        .config = config, .rig = {}, .format = {}, .faults = {}, .command = std::move(command)};
    auto rig = config::load_rig(config.recording.empty() ? config.rig : config.recording);
    if (!rig) return tl::unexpected(rig.error());
    plan.rig = std::move(*rig);
    if (config.rate_hz > 0.0) plan.rig.rate_hz = config.rate_hz;
    if (auto checked = check(plan.rig); !checked) return tl::unexpected(checked.error());
    warn_about(plan.rig, config.recording.empty() ? config.rig : config.recording / "rig.toml");
    auto format = find_pixel_format(config.pixel_format);
    if (!format) return tl::unexpected(format.error());
    plan.format = config.write_recording.empty() ? *format : image::PixelFormat::kRgb;
    auto faults = parse_faults(config.faults, plan.rig);
    if (!faults) return tl::unexpected(faults.error());
    plan.faults = std::move(*faults);
    return plan;
}

void print(const Plan& plan) {
    fmt::print("{:<16} {:<16} {:<12} {:>10} {:>9} {:>8}\n",
               "camera",
               "serial",
               "address",
               "size",
               "format",
               "rate");
    const std::vector<CameraIdentity> identities = identities_of(plan.rig);
    for (std::size_t i = 0; i < identities.size(); ++i) {
        const geometry::PinholeCamera& c = plan.rig.cameras[i].intrinsics;
        fmt::print("{:<16} {:<16} {:<12} {:>10} {:>9} {:>5} Hz\n",
                   identities[i].name,
                   identities[i].serial,
                   identities[i].address,
                   fmt::format("{}x{}", c.width & ~1, c.height & ~1),
                   plan.config.pixel_format,
                   plan.rig.rate_hz);
    }
}

Expected<void> write(const Plan& plan, std::stop_token stop) {
    constexpr double kSeconds = 30.0;
    const SimulatedCamerasConfig& config = plan.config;
    // before the slow rendering
    if (auto usable = check_recording_folder(config.write_recording); !usable) return usable;
    auto shown = load_pictures(plan, stop);
    if (!shown) return tl::unexpected(shown.error());
    std::size_t last_step = 0;
    const auto report = [&](std::size_t done, std::size_t total) {
        const std::size_t step = done * 10 / total;
        if (step != last_step) app::log::info("writing the recording {} %", step * 10);
        last_step = step;
    };
    ThreadPool pool(std::max(1U, std::thread::hardware_concurrency()));
    const auto written = write_recording(*shown,
                                         config.rig,
                                         config.seconds > 0.0 ? config.seconds : kSeconds,
                                         config.write_recording,
                                         pool,
                                         report,
                                         stop);
    if (written) app::log::info("wrote recording={}", config.write_recording.string());
    return written;
}

Expected<void> enter_network(const Plan& plan) {
    if (!plan.config.own_network) return {};
    if (auto entered = app::enter_private_network(); !entered) return entered;
    return app::bring_up_loopback(static_cast<int>(plan.rig.cameras.size()) + 1);
}

Expected<int> run(const Plan& plan, std::stop_token stop) {
    auto shown = load_pictures(plan, stop);
    if (!shown) return tl::unexpected(shown.error());
    if (stop.stop_requested()) return 0;
    if (plan.config.rate_hz > 0.0) shown->rig.rate_hz = plan.config.rate_hz;
    const ServerOptions options{.empty_time = std::chrono::microseconds(
                                    static_cast<std::int64_t>(plan.config.empty_seconds * 1e6)),
                                .stamp = plan.config.stamp,
                                .seed = plan.config.seed,
                                .faults = plan.faults};
    auto server = CameraServer::start(std::move(*shown), options);
    if (!server) return tl::unexpected(server.error());
    app::log::info("serving cameras={} rate_hz={} format={} process={}",
                   plan.rig.cameras.size(),
                   plan.rig.rate_hz,
                   plan.config.pixel_format,
                   getpid());
    if (plan.config.own_network) app::log::info("{}", network_notice(plan.command, getpid()));
    std::stop_source end;
    const std::stop_callback pass_on(stop, [&end] { end.request_stop(); });
    Expected<int> exit_code = 0;
    {
        const std::jthread faults(
            [&server](std::stop_token ended) { (*server)->follow_outages(ended); });
        const std::jthread limit =
            plan.config.seconds > 0.0 ? time_limit(plan.config.seconds, end) : std::jthread();
        exit_code = run_command(plan.command, end.get_token(), [&server] {
            app::log::info("the room is empty for a while");
            (*server)->empty_room();
        });
    }
    const std::vector<std::uint64_t> num_sent = (*server)->num_sent();
    for (std::size_t i = 0; i < num_sent.size(); ++i) {
        app::log::info(
            "camera name={} pictures_sent={}", (*server)->identities()[i].name, num_sent[i]);
    }
    return exit_code;
}

}  // namespace atrium::simulated_cameras
