#include "world_server/endpoints.hpp"

#include <utility>

namespace atrium::world_server {
namespace {

// Returns the first error, or null.
template <typename... Results>
const Error* first_error(const Results&... results) {
    const Error* first = nullptr;
    ((first = first == nullptr && !results ? &results.error() : first), ...);
    return first;
}

}  // namespace

Expected<Endpoints> Endpoints::create(const bus::BusOptions& options) {
    auto participant = bus::Participant::create(options);
    if (!participant) return tl::unexpected(participant.error());
    auto descriptions = bus::Reader<bus::SiteDescription>::create(*participant);
    auto meshes = bus::Reader<bus::SiteMesh>::create(*participant);
    auto commands = bus::Reader<bus::SceneCommand>::create(*participant);
    auto edits = bus::Reader<bus::SceneEdit>::create(*participant);
    auto objects = bus::Writer<bus::SceneObject>::create(*participant);
    auto soft_bodies = bus::Writer<bus::SoftBody>::create(*participant);
    auto scenery = bus::Writer<bus::Scenery>::create(*participant);
    auto states = bus::Writer<bus::SceneState>::create(*participant);
    auto soft_states = bus::Writer<bus::SoftBodyState>::create(*participant);
    auto placements = bus::Writer<bus::SitePlacement>::create(*participant);
    auto person_proxies = bus::Writer<bus::PersonProxy>::create(*participant);
    auto object_proxies = bus::Writer<bus::ObjectProxy>::create(*participant);
    auto edit_results = bus::Writer<bus::EditResult>::create(*participant);
    auto saved_worlds = bus::Writer<bus::SavedWorlds>::create(*participant);
    auto statuses = bus::Writer<bus::WorldStatus>::create(*participant);
    auto waiter = bus::Waiter::create(*participant);
    const Error* error = first_error(descriptions,
                                     meshes,
                                     commands,
                                     edits,
                                     objects,
                                     soft_bodies,
                                     scenery,
                                     states,
                                     soft_states,
                                     placements,
                                     person_proxies,
                                     object_proxies,
                                     edit_results,
                                     saved_worlds,
                                     statuses,
                                     waiter);
    if (error != nullptr) return tl::unexpected(*error);
    waiter->add(*descriptions);
    waiter->add(*meshes);
    waiter->add(*commands);
    waiter->add(*edits);
    return Endpoints{std::move(*participant),
                     std::move(*descriptions),
                     std::move(*meshes),
                     std::move(*commands),
                     std::move(*edits),
                     std::move(*objects),
                     std::move(*soft_bodies),
                     std::move(*scenery),
                     std::move(*states),
                     std::move(*soft_states),
                     std::move(*placements),
                     std::move(*person_proxies),
                     std::move(*object_proxies),
                     std::move(*edit_results),
                     std::move(*saved_worlds),
                     std::move(*statuses),
                     std::move(*waiter)};
}

}  // namespace atrium::world_server
