#pragma once

#include "core/bus/messages.hpp"

#include <feedback.h>
#include <presence.h>
#include <proxy.h>
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

template <typename WireType, const dds_topic_descriptor_t& kTypeDescriptor>
struct WireTopic {
    using Wire = WireType;
    static constexpr const dds_topic_descriptor_t& kDescriptor = kTypeDescriptor;
};

template <typename Message>
struct Topic;

template <>
struct Topic<SiteDescription> : WireTopic<atrium_SiteDescription, atrium_SiteDescription_desc> {
    static constexpr const char* kName = "SiteDescription";
    static constexpr std::string_view kProfile = kDescription;
};
template <>
struct Topic<SiteMesh> : WireTopic<atrium_SiteMesh, atrium_SiteMesh_desc> {
    static constexpr const char* kName = "SiteMesh";
    static constexpr std::string_view kProfile = kStream;
};
template <>
struct Topic<CameraTexture> : WireTopic<atrium_CameraTexture, atrium_CameraTexture_desc> {
    static constexpr const char* kName = "CameraTexture";
    static constexpr std::string_view kProfile = kTexture;
};
template <>
struct Topic<SitePlacement> : WireTopic<atrium_SitePlacement, atrium_SitePlacement_desc> {
    static constexpr const char* kName = "SitePlacement";
    static constexpr std::string_view kProfile = kDescription;
};
template <>
struct Topic<SceneObject> : WireTopic<atrium_SceneObject, atrium_SceneObject_desc> {
    static constexpr const char* kName = "SceneObject";
    static constexpr std::string_view kProfile = kDescription;
};
template <>
struct Topic<SoftBody> : WireTopic<atrium_SoftBody, atrium_SoftBody_desc> {
    static constexpr const char* kName = "SoftBody";
    static constexpr std::string_view kProfile = kDescription;
};
template <>
struct Topic<SoftBodyState> : WireTopic<atrium_SoftBodyState, atrium_SoftBodyState_desc> {
    static constexpr const char* kName = "SoftBodyState";
    static constexpr std::string_view kProfile = kStream;
};
template <>
struct Topic<Scenery> : WireTopic<atrium_Scenery, atrium_Scenery_desc> {
    static constexpr const char* kName = "Scenery";
    static constexpr std::string_view kProfile = kDescription;
};
template <>
struct Topic<SceneState> : WireTopic<atrium_SceneState, atrium_SceneState_desc> {
    static constexpr const char* kName = "SceneState";
    static constexpr std::string_view kProfile = kStream;
};
template <>
struct Topic<PersonProxy> : WireTopic<atrium_PersonProxy, atrium_PersonProxy_desc> {
    static constexpr const char* kName = "PersonProxy";
    static constexpr std::string_view kProfile = kTexture;
};
template <>
struct Topic<ObjectProxy> : WireTopic<atrium_ObjectProxy, atrium_ObjectProxy_desc> {
    static constexpr const char* kName = "ObjectProxy";
    static constexpr std::string_view kProfile = kDescription;
};
template <>
struct Topic<SceneCommand> : WireTopic<atrium_SceneCommand, atrium_SceneCommand_desc> {
    static constexpr const char* kName = "SceneCommand";
    static constexpr std::string_view kProfile = kCommand;
};
template <>
struct Topic<SiteStatus> : WireTopic<atrium_SiteStatus, atrium_SiteStatus_desc> {
    static constexpr const char* kName = "SiteStatus";
    static constexpr std::string_view kProfile = kStatus;
};
template <>
struct Topic<WorldStatus> : WireTopic<atrium_WorldStatus, atrium_WorldStatus_desc> {
    static constexpr const char* kName = "WorldStatus";
    static constexpr std::string_view kProfile = kStatus;
};
template <>
struct Topic<ViewerStatus> : WireTopic<atrium_ViewerStatus, atrium_ViewerStatus_desc> {
    static constexpr const char* kName = "ViewerStatus";
    static constexpr std::string_view kProfile = kStatus;
};
template <>
struct Topic<StreamFeedback> : WireTopic<atrium_StreamFeedback, atrium_StreamFeedback_desc> {
    static constexpr const char* kName = "StreamFeedback";
    static constexpr std::string_view kProfile = kStatus;
};
template <>
struct Topic<Presence> : WireTopic<atrium_Presence, atrium_Presence_desc> {
    static constexpr const char* kName = "Presence";
    static constexpr std::string_view kProfile = kDescription;
};

}  // namespace atrium::bus
