#pragma once

#include "core/bus/messages.hpp"

#include <editing.h>
#include <feedback.h>
#include <hosts.h>
#include <presence.h>
#include <proxy.h>
#include <recording.h>
#include <site.h>
#include <status.h>
#include <world.h>

#include <array>
#include <string_view>

/// Maps each message to its topic, wire type and QoS profile. Private to core/bus and its tests.
namespace atrium::bus {

inline constexpr std::string_view kDescription = "description";
inline constexpr std::string_view kStream = "stream";
inline constexpr std::string_view kTexture = "texture";
inline constexpr std::string_view kCommand = "command";
inline constexpr std::string_view kStatus = "status";
inline constexpr std::array kProfileNames{kDescription, kStream, kTexture, kCommand, kStatus};

template <typename WireType,
          const dds_topic_descriptor_t& kTypeDescriptor,
          const std::string_view& kQosProfile>
struct WireTopic {
    using Wire = WireType;
    static constexpr const dds_topic_descriptor_t& kDescriptor = kTypeDescriptor;
    static constexpr std::string_view kProfile = kQosProfile;
};

template <typename Message>
struct Topic;

template <>
struct Topic<SiteDescription>
    : WireTopic<atrium_SiteDescription, atrium_SiteDescription_desc, kDescription> {
    static constexpr const char* kName = "SiteDescription";
};
template <>
struct Topic<SiteMesh> : WireTopic<atrium_SiteMesh, atrium_SiteMesh_desc, kStream> {
    static constexpr const char* kName = "SiteMesh";
};
template <>
struct Topic<CameraTexture> : WireTopic<atrium_CameraTexture, atrium_CameraTexture_desc, kTexture> {
    static constexpr const char* kName = "CameraTexture";
};
template <>
struct Topic<CameraSilhouette>
    : WireTopic<atrium_CameraSilhouette, atrium_CameraSilhouette_desc, kTexture> {
    static constexpr const char* kName = "CameraSilhouette";
};
template <>
struct Topic<SiteOrders> : WireTopic<atrium_SiteOrders, atrium_SiteOrders_desc, kTexture> {
    static constexpr const char* kName = "SiteOrders";
};
template <>
struct Topic<ClockAnswer> : WireTopic<atrium_ClockAnswer, atrium_ClockAnswer_desc, kTexture> {
    static constexpr const char* kName = "ClockAnswer";
};
template <>
struct Topic<CameraNodeStatus>
    : WireTopic<atrium_CameraNodeStatus, atrium_CameraNodeStatus_desc, kStatus> {
    static constexpr const char* kName = "CameraNodeStatus";
};
template <>
struct Topic<RegionOrder> : WireTopic<atrium_RegionOrder, atrium_RegionOrder_desc, kTexture> {
    static constexpr const char* kName = "RegionOrder";
};
template <>
struct Topic<RegionMeshes> : WireTopic<atrium_RegionMeshes, atrium_RegionMeshes_desc, kTexture> {
    static constexpr const char* kName = "RegionMeshes";
};
template <>
struct Topic<RegionNodeStatus>
    : WireTopic<atrium_RegionNodeStatus, atrium_RegionNodeStatus_desc, kStatus> {
    static constexpr const char* kName = "RegionNodeStatus";
};
template <>
struct Topic<SitePlacement>
    : WireTopic<atrium_SitePlacement, atrium_SitePlacement_desc, kDescription> {
    static constexpr const char* kName = "SitePlacement";
};
template <>
struct Topic<SceneObject> : WireTopic<atrium_SceneObject, atrium_SceneObject_desc, kDescription> {
    static constexpr const char* kName = "SceneObject";
};
template <>
struct Topic<SoftBody> : WireTopic<atrium_SoftBody, atrium_SoftBody_desc, kDescription> {
    static constexpr const char* kName = "SoftBody";
};
template <>
struct Topic<SoftBodyState> : WireTopic<atrium_SoftBodyState, atrium_SoftBodyState_desc, kStream> {
    static constexpr const char* kName = "SoftBodyState";
};
template <>
struct Topic<Scenery> : WireTopic<atrium_Scenery, atrium_Scenery_desc, kDescription> {
    static constexpr const char* kName = "Scenery";
};
template <>
struct Topic<SceneState> : WireTopic<atrium_SceneState, atrium_SceneState_desc, kStream> {
    static constexpr const char* kName = "SceneState";
};
template <>
struct Topic<PersonProxy> : WireTopic<atrium_PersonProxy, atrium_PersonProxy_desc, kTexture> {
    static constexpr const char* kName = "PersonProxy";
};
template <>
struct Topic<ObjectProxy> : WireTopic<atrium_ObjectProxy, atrium_ObjectProxy_desc, kDescription> {
    static constexpr const char* kName = "ObjectProxy";
};
template <>
struct Topic<SceneCommand> : WireTopic<atrium_SceneCommand, atrium_SceneCommand_desc, kCommand> {
    static constexpr const char* kName = "SceneCommand";
};
template <>
struct Topic<SceneEdit> : WireTopic<atrium_SceneEdit, atrium_SceneEdit_desc, kCommand> {
    static constexpr const char* kName = "SceneEdit";
};
template <>
struct Topic<EditResult> : WireTopic<atrium_EditResult, atrium_EditResult_desc, kTexture> {
    static constexpr const char* kName = "EditResult";
};
template <>
struct Topic<SavedWorlds> : WireTopic<atrium_SavedWorlds, atrium_SavedWorlds_desc, kDescription> {
    static constexpr const char* kName = "SavedWorlds";
};
template <>
struct Topic<RoomRecordOrder>
    : WireTopic<atrium_RoomRecordOrder, atrium_RoomRecordOrder_desc, kCommand> {
    static constexpr const char* kName = "RoomRecordOrder";
};
template <>
struct Topic<RoomRecording> : WireTopic<atrium_RoomRecording, atrium_RoomRecording_desc, kStatus> {
    static constexpr const char* kName = "RoomRecording";
};
template <>
struct Topic<SiteStatus> : WireTopic<atrium_SiteStatus, atrium_SiteStatus_desc, kStatus> {
    static constexpr const char* kName = "SiteStatus";
};
template <>
struct Topic<WorldStatus> : WireTopic<atrium_WorldStatus, atrium_WorldStatus_desc, kStatus> {
    static constexpr const char* kName = "WorldStatus";
};
template <>
struct Topic<ViewerStatus> : WireTopic<atrium_ViewerStatus, atrium_ViewerStatus_desc, kStatus> {
    static constexpr const char* kName = "ViewerStatus";
};
template <>
struct Topic<StreamFeedback>
    : WireTopic<atrium_StreamFeedback, atrium_StreamFeedback_desc, kStatus> {
    static constexpr const char* kName = "StreamFeedback";
};
template <>
struct Topic<Presence> : WireTopic<atrium_Presence, atrium_Presence_desc, kDescription> {
    static constexpr const char* kName = "Presence";
};
template <>
struct Topic<RevokedKeys> : WireTopic<atrium_RevokedKeys, atrium_RevokedKeys_desc, kDescription> {
    static constexpr const char* kName = "RevokedKeys";
};

}  // namespace atrium::bus
