#include "core/presence/join_world.hpp"

#include "core/app/log.hpp"
#include "core/app/program.hpp"

#include <utility>

namespace atrium::presence {

Expected<std::unique_ptr<Membership>> join_world(const bus::Participant& participant,
                                                 bus::ProgramKind kind,
                                                 const std::string& name,
                                                 std::function<void(const Error&)> on_name_lost,
                                                 std::stop_token stop) {
    const bus::NetworkReport& network = participant.network();
    app::log::info("{}", network.line);
    for (const std::string& warning : network.warnings) app::log::warn("{}", warning);
    return Membership::join(participant,
                            {kind, name, app::version()},
                            {.info = [](const std::string& line) { app::log::info("{}", line); },
                             .warn = [](const std::string& line) { app::log::warn("{}", line); },
                             .name_lost = std::move(on_name_lost)},
                            stop);
}

}  // namespace atrium::presence
