#include "world_server/command_reception.hpp"

#include <utility>

namespace atrium::world_server {
namespace {

// Only this server says which files it has.
void disregard_fingerprints(bus::SceneObject& object) {
    object.model_fingerprint = {};
    object.texture_fingerprint = {};
}

}  // namespace

std::optional<std::string> receive(Simulation& simulation,
                                   bus::SceneCommand&& command,
                                   CommandRates::Clock::time_point now) {
    disregard_fingerprints(command.object);
    const std::string sender = command.sender;
    const bus::CommandKind kind = command.kind;
    const std::uint32_t target = command.target;
    auto why = simulation.commands().put(std::move(command), now);
    if (!why) return std::nullopt;
    if (auto answer = simulation.answers().refused(sender, kind, target, *why, now))
        simulation.outbox().put(std::move(*answer));
    return "command of " + sender + ": " + *why;
}

std::optional<std::string> receive(Simulation& simulation,
                                   bus::SceneEdit&& edit,
                                   CommandRates::Clock::time_point now) {
    disregard_fingerprints(edit.object);
    auto why = simulation.commands().admit(edit, now);
    const bool has_room =
        why || (needs_files(edit) ? simulation.edit_worker().prepare(edit)
                                  : simulation.commands().put_prepared({edit, nullptr, nullptr}));
    if (!has_room) why = "too many edits at once";
    if (!why) return std::nullopt;
    simulation.outbox().put(result_of(edit, false, *why));
    return "edit of " + edit.sender + ": " + *why;
}

void forget_sender(Simulation& simulation, const bus::SceneCommand& gone) {
    simulation.commands().leave(gone.sender);
    simulation.answers().forget(gone.sender);
    simulation.outbox().leave(gone.sender);
}

void forget_sender(Simulation& simulation, const bus::SceneEdit& gone) {
    simulation.commands().leave(gone.sender);
    simulation.outbox().leave(gone.sender);
}

}  // namespace atrium::world_server
