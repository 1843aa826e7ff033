#include "viewer/receive/session.hpp"

namespace atrium::viewer {
namespace {

template <typename T>
bool assign(Expected<T> created, std::optional<T>& out, Error& error) {
    if (created)
        out.emplace(std::move(*created));
    else
        error = created.error();
    return out.has_value();
}

}  // namespace

Expected<std::unique_ptr<Session>> Session::create(const bus::BusOptions& options,
                                                   const std::string& viewer) {
    auto participant = bus::Participant::create(options);
    if (!participant) return tl::unexpected(participant.error());
    std::optional<bus::Waiter> waiter;
    std::optional<bus::Reader<bus::SiteDescription>> descriptions;
    std::optional<bus::Reader<bus::SitePlacement>> placements;
    std::optional<bus::Reader<bus::SiteMesh>> meshes;
    std::optional<bus::Reader<bus::CameraTexture>> textures;
    std::optional<bus::Reader<bus::SceneObject>> objects;
    std::optional<bus::Reader<bus::SoftBody>> soft_bodies;
    std::optional<bus::Reader<bus::SoftBodyState>> soft_states;
    std::optional<bus::Reader<bus::Scenery>> scenery;
    std::optional<bus::Reader<bus::SceneState>> states;
    std::optional<bus::Reader<bus::SiteStatus>> site_statuses;
    std::optional<bus::Reader<bus::WorldStatus>> world_statuses;
    std::optional<bus::Writer<bus::ViewerStatus>> status;
    std::optional<bus::Writer<bus::SceneCommand>> commands;
    std::optional<bus::Writer<bus::StreamFeedback>> feedback;
    Error error;
    const bool all_created =
        assign(bus::Waiter::create(*participant), waiter, error) &&
        assign(bus::Reader<bus::SiteDescription>::create(*participant), descriptions, error) &&
        assign(bus::Reader<bus::SitePlacement>::create(*participant), placements, error) &&
        assign(bus::Reader<bus::SiteMesh>::create(*participant), meshes, error) &&
        assign(bus::Reader<bus::CameraTexture>::create(*participant), textures, error) &&
        assign(bus::Reader<bus::SceneObject>::create(*participant), objects, error) &&
        assign(bus::Reader<bus::SoftBody>::create(*participant), soft_bodies, error) &&
        assign(bus::Reader<bus::SoftBodyState>::create(*participant), soft_states, error) &&
        assign(bus::Reader<bus::Scenery>::create(*participant), scenery, error) &&
        assign(bus::Reader<bus::SceneState>::create(*participant), states, error) &&
        assign(bus::Reader<bus::SiteStatus>::create(*participant), site_statuses, error) &&
        assign(bus::Reader<bus::WorldStatus>::create(*participant), world_statuses, error) &&
        assign(bus::Writer<bus::ViewerStatus>::create(*participant), status, error) &&
        assign(bus::Writer<bus::SceneCommand>::create(*participant), commands, error) &&
        assign(bus::Writer<bus::StreamFeedback>::create(*participant), feedback, error);
    if (!all_created) return tl::unexpected(error);
    auto edits = EditLink::create(*participant, *waiter, viewer);
    if (!edits) return tl::unexpected(edits.error());
    waiter->add(*descriptions);
    waiter->add(*placements);
    waiter->add(*meshes);
    waiter->add(*textures);
    waiter->add(*objects);
    waiter->add(*soft_bodies);
    waiter->add(*soft_states);
    waiter->add(*scenery);
    waiter->add(*states);
    waiter->add(*site_statuses);
    waiter->add(*world_statuses);
    return std::unique_ptr<Session>(new Session({*participant,
                                                 std::move(*waiter),
                                                 std::move(*descriptions),
                                                 std::move(*placements),
                                                 std::move(*meshes),
                                                 std::move(*textures),
                                                 std::move(*objects),
                                                 std::move(*soft_bodies),
                                                 std::move(*soft_states),
                                                 std::move(*scenery),
                                                 std::move(*states),
                                                 std::move(*site_statuses),
                                                 std::move(*world_statuses)},
                                                std::move(*status),
                                                std::move(*commands),
                                                std::move(*feedback),
                                                std::move(*edits),
                                                viewer));
}

}  // namespace atrium::viewer
