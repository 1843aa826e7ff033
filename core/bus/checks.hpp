#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"

#include <string_view>

/// The rules that every message keeps on both sides of the network (limits.hpp has the numbers). An
/// error is kInvalidData and names the field and what is allowed.
namespace atrium::bus {

bool is_valid_name(std::string_view name);

/// 1..127 characters of [A-Za-z0-9_.-/], relative, no part of it empty or with a dot in front: what
/// it names lies in the folder that it is appended to.
bool is_valid_model_file(std::string_view file);

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
