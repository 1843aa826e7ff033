#include "site_node/simulated_room/open_room.hpp"

#include "core/app/log.hpp"
#include "simulation/model.hpp"
#include "simulation/wrong_cameras.hpp"
#include "site_node/simulated_room/rendered_source.hpp"
#include "site_node/simulated_room/simulated_source.hpp"

#include <filesystem>
#include <system_error>
#include <utility>

namespace atrium::simulated_room {

Expected<std::unique_ptr<capture::FrameSource>> open_room(const config::Rig& rig,
                                                          const simulation::RoomConfig& config,
                                                          std::stop_token stop) {
    const auto wrong = simulation::WrongCameras::create(config, rig.cameras);
    if (!wrong) return tl::unexpected(wrong.error());
    config::Rig rendered = rig;
    rendered.cameras = wrong->rendered(rig.cameras);
    if (auto made = simulation::rendered_room(rendered, config))
        return std::make_unique<RenderedSource>(rig, std::move(made), *wrong);
    const simulation::RoomOptions room = simulation::room_options(config, rig.rate_hz);
    if (!room.model.empty()) {
        // here, not while rendering: a loop from the cache has the same faults
        const auto model = simulation::examine_model(room);
        if (!model) return tl::unexpected(model.error());
        app::log::info("model file={} {}", room.model.string(), simulation::describe(*model));
        for (const std::string& warning : model->warnings)
            app::log::warn("model file={} {}", room.model.string(), warning);
    }
    int last_percent = -1;
    const auto report = [&](std::size_t done, std::size_t total) {
        if (total == 0) return app::log::info("another program renders this room: waiting for it");
        const int percent = static_cast<int>(done * 100 / total);
        if (percent / 5 == last_percent / 5 && percent != 100) return;
        last_percent = percent;
        app::log::info("rendering the simulated room {} %", percent);
    };
    auto source = SimulatedSource::create(
        rig, room, config.cache, report, stop, *wrong, simulation::changing_light(config));
    if (!source) return tl::unexpected(source.error());
    if (const std::string& problem = (*source)->cache_problem(); !problem.empty()) {
        app::log::warn("the rendered room cannot be cached reason=\"{}\"", problem);
    }
    if (const std::filesystem::path& file = (*source)->cache_written(); !file.empty()) {
        std::error_code failure;
        app::log::info("the rendered room is kept file={} megabytes={}",
                       file.string(),
                       std::filesystem::file_size(file, failure) / 1'000'000);
    }
    return std::unique_ptr<capture::FrameSource>(std::move(*source));
}

}  // namespace atrium::simulated_room
