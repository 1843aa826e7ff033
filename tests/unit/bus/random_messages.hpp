#pragma once

#include "core/bus/messages.hpp"

#include <random>

/// Random valid messages, and their comparison.
namespace atrium::bus::testing {

using Random = std::mt19937_64;

template <typename Message>
Message random_message(Random& random);
template <>
SiteDescription random_message(Random& random);
template <>
SiteMesh random_message(Random& random);
template <>
CameraTexture random_message(Random& random);
template <>
SitePlacement random_message(Random& random);
template <>
SceneObject random_message(Random& random);
template <>
SoftBody random_message(Random& random);
template <>
SoftBodyState random_message(Random& random);
template <>
Scenery random_message(Random& random);
template <>
SceneState random_message(Random& random);
template <>
PersonProxy random_message(Random& random);
template <>
ObjectProxy random_message(Random& random);
template <>
SceneCommand random_message(Random& random);
template <>
SiteStatus random_message(Random& random);
template <>
WorldStatus random_message(Random& random);
template <>
ViewerStatus random_message(Random& random);
template <>
StreamFeedback random_message(Random& random);
template <>
Presence random_message(Random& random);

bool same(const SiteDescription& a, const SiteDescription& b);
bool same(const SiteMesh& a, const SiteMesh& b);
bool same(const CameraTexture& a, const CameraTexture& b);
bool same(const SitePlacement& a, const SitePlacement& b);
bool same(const SceneObject& a, const SceneObject& b);
bool same(const SoftBody& a, const SoftBody& b);
bool same(const SoftBodyState& a, const SoftBodyState& b);
bool same(const Scenery& a, const Scenery& b);
bool same(const SceneState& a, const SceneState& b);
bool same(const PersonProxy& a, const PersonProxy& b);
bool same(const ObjectProxy& a, const ObjectProxy& b);
bool same(const SceneCommand& a, const SceneCommand& b);
bool same(const SiteStatus& a, const SiteStatus& b);
bool same(const WorldStatus& a, const WorldStatus& b);
bool same(const ViewerStatus& a, const ViewerStatus& b);
bool same(const StreamFeedback& a, const StreamFeedback& b);
bool same(const Presence& a, const Presence& b);

}  // namespace atrium::bus::testing
