#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"

#include <feedback.h>
#include <presence.h>
#include <proxy.h>
#include <site.h>
#include <status.h>
#include <world.h>

#include <cstddef>
#include <vector>

/// Converts messages to and from the structs that idlc generates from idl/. Private to core/bus and
/// its tests.
///
/// `to_wire` points the sequences of `out` into the message and into `scratch`, which must outlive
/// `out`. `from_wire` copies, and is safe for untrusted input: its result has passed `check`, and
/// quaternions within the tolerance are normalised. `key_to_wire` and `key_from_wire` convert only
/// the key fields. `payload_bytes` counts names, numbers and coded bytes, without the padding and
/// headers of the protocol.
namespace atrium::bus {

struct WireScratch {
    std::vector<atrium_Camera> cameras;
    std::vector<atrium_ObjectState> objects;
    std::vector<atrium_CameraStatus> camera_statuses;
    std::vector<atrium_ProxyPoint> proxy_points;
    std::vector<atrium_Touch> touches;
};

void to_wire(const SiteDescription& message, WireScratch& scratch, atrium_SiteDescription& out);
void to_wire(const SiteMesh& message, WireScratch& scratch, atrium_SiteMesh& out);
void to_wire(const CameraTexture& message, WireScratch& scratch, atrium_CameraTexture& out);
void to_wire(const SitePlacement& message, WireScratch& scratch, atrium_SitePlacement& out);
void to_wire(const SceneObject& message, WireScratch& scratch, atrium_SceneObject& out);
void to_wire(const SoftBody& message, WireScratch& scratch, atrium_SoftBody& out);
void to_wire(const SoftBodyState& message, WireScratch& scratch, atrium_SoftBodyState& out);
void to_wire(const Scenery& message, WireScratch& scratch, atrium_Scenery& out);
void to_wire(const SceneState& message, WireScratch& scratch, atrium_SceneState& out);
void to_wire(const PersonProxy& message, WireScratch& scratch, atrium_PersonProxy& out);
void to_wire(const ObjectProxy& message, WireScratch& scratch, atrium_ObjectProxy& out);
void to_wire(const SceneCommand& message, WireScratch& scratch, atrium_SceneCommand& out);
void to_wire(const SiteStatus& message, WireScratch& scratch, atrium_SiteStatus& out);
void to_wire(const WorldStatus& message, WireScratch& scratch, atrium_WorldStatus& out);
void to_wire(const ViewerStatus& message, WireScratch& scratch, atrium_ViewerStatus& out);
void to_wire(const StreamFeedback& message, WireScratch& scratch, atrium_StreamFeedback& out);
void to_wire(const Presence& message, WireScratch& scratch, atrium_Presence& out);

Expected<SiteDescription> from_wire(const atrium_SiteDescription& wire);
Expected<SiteMesh> from_wire(const atrium_SiteMesh& wire);
Expected<CameraTexture> from_wire(const atrium_CameraTexture& wire);
Expected<SitePlacement> from_wire(const atrium_SitePlacement& wire);
Expected<SceneObject> from_wire(const atrium_SceneObject& wire);
Expected<SoftBody> from_wire(const atrium_SoftBody& wire);
Expected<SoftBodyState> from_wire(const atrium_SoftBodyState& wire);
Expected<Scenery> from_wire(const atrium_Scenery& wire);
Expected<SceneState> from_wire(const atrium_SceneState& wire);
Expected<PersonProxy> from_wire(const atrium_PersonProxy& wire);
Expected<ObjectProxy> from_wire(const atrium_ObjectProxy& wire);
Expected<SceneCommand> from_wire(const atrium_SceneCommand& wire);
Expected<SiteStatus> from_wire(const atrium_SiteStatus& wire);
Expected<WorldStatus> from_wire(const atrium_WorldStatus& wire);
Expected<ViewerStatus> from_wire(const atrium_ViewerStatus& wire);
Expected<StreamFeedback> from_wire(const atrium_StreamFeedback& wire);
Expected<Presence> from_wire(const atrium_Presence& wire);

void key_to_wire(const SiteDescription& message, atrium_SiteDescription& out);
void key_to_wire(const SiteMesh& message, atrium_SiteMesh& out);
void key_to_wire(const CameraTexture& message, atrium_CameraTexture& out);
void key_to_wire(const SitePlacement& message, atrium_SitePlacement& out);
void key_to_wire(const SceneObject& message, atrium_SceneObject& out);
void key_to_wire(const SoftBody& message, atrium_SoftBody& out);
void key_to_wire(const SoftBodyState& message, atrium_SoftBodyState& out);
void key_to_wire(const Scenery& message, atrium_Scenery& out);
void key_to_wire(const SceneState& message, atrium_SceneState& out);
void key_to_wire(const PersonProxy& message, atrium_PersonProxy& out);
void key_to_wire(const ObjectProxy& message, atrium_ObjectProxy& out);
void key_to_wire(const SceneCommand& message, atrium_SceneCommand& out);
void key_to_wire(const SiteStatus& message, atrium_SiteStatus& out);
void key_to_wire(const WorldStatus& message, atrium_WorldStatus& out);
void key_to_wire(const ViewerStatus& message, atrium_ViewerStatus& out);
void key_to_wire(const StreamFeedback& message, atrium_StreamFeedback& out);
void key_to_wire(const Presence& message, atrium_Presence& out);

Expected<SiteDescription> key_from_wire(const atrium_SiteDescription& wire);
Expected<SiteMesh> key_from_wire(const atrium_SiteMesh& wire);
Expected<CameraTexture> key_from_wire(const atrium_CameraTexture& wire);
Expected<SitePlacement> key_from_wire(const atrium_SitePlacement& wire);
Expected<SceneObject> key_from_wire(const atrium_SceneObject& wire);
Expected<SoftBody> key_from_wire(const atrium_SoftBody& wire);
Expected<SoftBodyState> key_from_wire(const atrium_SoftBodyState& wire);
Expected<Scenery> key_from_wire(const atrium_Scenery& wire);
Expected<SceneState> key_from_wire(const atrium_SceneState& wire);
Expected<PersonProxy> key_from_wire(const atrium_PersonProxy& wire);
Expected<ObjectProxy> key_from_wire(const atrium_ObjectProxy& wire);
Expected<SceneCommand> key_from_wire(const atrium_SceneCommand& wire);
Expected<SiteStatus> key_from_wire(const atrium_SiteStatus& wire);
Expected<WorldStatus> key_from_wire(const atrium_WorldStatus& wire);
Expected<ViewerStatus> key_from_wire(const atrium_ViewerStatus& wire);
Expected<StreamFeedback> key_from_wire(const atrium_StreamFeedback& wire);
Expected<Presence> key_from_wire(const atrium_Presence& wire);

std::size_t payload_bytes(const SiteDescription& message);
std::size_t payload_bytes(const SiteMesh& message);
std::size_t payload_bytes(const CameraTexture& message);
std::size_t payload_bytes(const SitePlacement& message);
std::size_t payload_bytes(const SceneObject& message);
std::size_t payload_bytes(const SoftBody& message);
std::size_t payload_bytes(const SoftBodyState& message);
std::size_t payload_bytes(const Scenery& message);
std::size_t payload_bytes(const SceneState& message);
std::size_t payload_bytes(const PersonProxy& message);
std::size_t payload_bytes(const ObjectProxy& message);
std::size_t payload_bytes(const SceneCommand& message);
std::size_t payload_bytes(const SiteStatus& message);
std::size_t payload_bytes(const WorldStatus& message);
std::size_t payload_bytes(const ViewerStatus& message);
std::size_t payload_bytes(const StreamFeedback& message);
std::size_t payload_bytes(const Presence& message);

}  // namespace atrium::bus
