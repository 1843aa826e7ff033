#pragma once

#include "core/bus/messages.hpp"

#include <gtest/gtest.h>

namespace atrium::bus::testing {

/// The messages of all topics, for typed tests.
using AllMessages = ::testing::Types<SiteDescription,
                                     SiteMesh,
                                     CameraTexture,
                                     CameraSilhouette,
                                     SiteOrders,
                                     ClockAnswer,
                                     CameraNodeStatus,
                                     RegionOrder,
                                     RegionMeshes,
                                     RegionNodeStatus,
                                     SitePlacement,
                                     SceneObject,
                                     SoftBody,
                                     SoftBodyState,
                                     Scenery,
                                     SceneState,
                                     PersonProxy,
                                     ObjectProxy,
                                     SceneCommand,
                                     SceneEdit,
                                     EditResult,
                                     SavedWorlds,
                                     RoomRecordOrder,
                                     RoomRecording,
                                     SiteStatus,
                                     WorldStatus,
                                     ViewerStatus,
                                     StreamFeedback,
                                     Presence,
                                     RevokedKeys>;

/// Those of `raw_topics`: not between the hosts of one site.
using RawMessages = ::testing::Types<SiteDescription,
                                     SiteMesh,
                                     CameraTexture,
                                     SitePlacement,
                                     SceneObject,
                                     SoftBody,
                                     SoftBodyState,
                                     Scenery,
                                     SceneState,
                                     PersonProxy,
                                     ObjectProxy,
                                     SceneCommand,
                                     SceneEdit,
                                     EditResult,
                                     SavedWorlds,
                                     RoomRecordOrder,
                                     RoomRecording,
                                     SiteStatus,
                                     WorldStatus,
                                     ViewerStatus,
                                     CameraNodeStatus,
                                     RegionNodeStatus,
                                     StreamFeedback,
                                     Presence>;

}  // namespace atrium::bus::testing
