#pragma once

#include "core/bus/messages.hpp"

#include <string>

namespace atrium::test {

/// The promises of core/bus/messages.hpp beyond finite numbers, names and times. Returns the broken
/// promise, or "".
std::string broken_promise(const bus::SiteDescription& message);
std::string broken_promise(const bus::SiteMesh& message);
std::string broken_promise(const bus::CameraTexture& message);
std::string broken_promise(const bus::CameraSilhouette& message);
std::string broken_promise(const bus::SiteOrders& message);
std::string broken_promise(const bus::ClockAnswer& message);
std::string broken_promise(const bus::CameraNodeStatus& message);
std::string broken_promise(const bus::RegionOrder& message);
std::string broken_promise(const bus::RegionMeshes& message);
std::string broken_promise(const bus::RegionNodeStatus& message);
std::string broken_promise(const bus::SitePlacement& message);
std::string broken_promise(const bus::SceneObject& message);
std::string broken_promise(const bus::SoftBody& message);
std::string broken_promise(const bus::SoftBodyState& message);
std::string broken_promise(const bus::Scenery& message);
std::string broken_promise(const bus::SceneState& message);
std::string broken_promise(const bus::PersonProxy& message);
std::string broken_promise(const bus::ObjectProxy& message);
std::string broken_promise(const bus::SceneCommand& message);
std::string broken_promise(const bus::SceneEdit& message);
std::string broken_promise(const bus::EditResult& message);
std::string broken_promise(const bus::SavedWorlds& message);
std::string broken_promise(const bus::RoomRecordOrder& message);
std::string broken_promise(const bus::RoomRecording& message);
std::string broken_promise(const bus::SiteStatus& message);
std::string broken_promise(const bus::WorldStatus& message);
std::string broken_promise(const bus::ViewerStatus& message);
std::string broken_promise(const bus::StreamFeedback& message);
std::string broken_promise(const bus::Presence& message);
std::string broken_promise(const bus::RevokedKeys& message);

}  // namespace atrium::test
