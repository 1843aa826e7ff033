#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "core/bus/names.hpp"

/// Checks messages: writers before they send, readers after they receive. limits.hpp has the
/// bounds. Errors are kInvalidData and name the field and the allowed values.
namespace atrium::bus {

Expected<void> check(const SiteDescription& message);
Expected<void> check(const SiteMesh& message);
Expected<void> check(const CameraTexture& message);
Expected<void> check(const SitePlacement& message);
Expected<void> check(const SceneObject& message);
Expected<void> check(const SoftBody& message);
Expected<void> check(const SoftBodyState& message);
Expected<void> check(const Scenery& message);
Expected<void> check(const SceneState& message);
Expected<void> check(const PersonProxy& message);
Expected<void> check(const ObjectProxy& message);
Expected<void> check(const SceneCommand& message);
Expected<void> check(const SiteStatus& message);
Expected<void> check(const WorldStatus& message);
Expected<void> check(const ViewerStatus& message);
Expected<void> check(const StreamFeedback& message);
Expected<void> check(const Presence& message);

}  // namespace atrium::bus
