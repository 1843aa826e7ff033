#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"

namespace atrium::world_server {

/// Readers and writers of all topics of a world server.
struct Endpoints {
    bus::Participant participant;
    bus::Reader<bus::SiteDescription> descriptions;
    bus::Reader<bus::SiteMesh> meshes;
    bus::Reader<bus::SceneCommand> commands;
    bus::Reader<bus::SceneEdit> edits;
    bus::Writer<bus::SceneObject> objects;
    bus::Writer<bus::SoftBody> soft_bodies;
    bus::Writer<bus::Scenery> scenery;
    bus::Writer<bus::SceneState> states;
    bus::Writer<bus::SoftBodyState> soft_states;
    bus::Writer<bus::SitePlacement> placements;
    bus::Writer<bus::PersonProxy> person_proxies;
    bus::Writer<bus::ObjectProxy> object_proxies;
    bus::Writer<bus::EditResult> edit_results;
    bus::Writer<bus::SavedWorlds> saved_worlds;
    bus::Writer<bus::WorldStatus> statuses;
    bus::Waiter waiter;

    static Expected<Endpoints> create(const bus::BusOptions& options);
};

}  // namespace atrium::world_server
