#include "core/keys/topics.hpp"

#include "core/bus/topics.hpp"
#include "tests/unit/bus/all_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::keys {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAreArray;

template <typename... Messages>
std::vector<std::string_view> names_of(::testing::Types<Messages...>) {
    return {bus::Topic<Messages>::kName...};
}

// A new topic must be given to somebody on purpose.
TEST(Topics, AreThoseOfTheBus) {
    std::vector<std::string_view> names;
    for (const Topic& topic : topics()) names.push_back(topic.name);
    EXPECT_THAT(names, UnorderedElementsAreArray(names_of(bus::testing::AllMessages())));
}

class WrittenAndRead : public ::testing::Test {
protected:
    std::vector<std::string> written(const Member& member, std::string_view topic) {
        return partitions_written(member, *find_topic(topic));
    }
    std::vector<std::string> read(const Member& member, std::string_view topic) {
        return partitions_read(member, *find_topic(topic));
    }

    Member site_{"w", Kind::kSite, "alice", {}};
    Member world_{"w", Kind::kWorld, "hall", {}};
    Member viewer_{"w", Kind::kViewer, "bob", {Right::kGrab, Right::kPush}};
    Member monitor_{"w", Kind::kMonitor, "mona", {}};
};

TEST_F(WrittenAndRead, GiveASiteItsOwnPartition) {
    for (const char* topic : {"SiteDescription",
                              "SiteMesh",
                              "CameraTexture",
                              "SiteStatus",
                              "CameraNodeStatus",
                              "RegionNodeStatus",
                              "RoomRecording"}) {
        EXPECT_THAT(written(site_, topic), ElementsAre("w/site/alice")) << topic;
        EXPECT_THAT(read(site_, topic), ElementsAre("w/site/alice")) << topic;
        EXPECT_THAT(read(world_, topic), ElementsAre("w/site/*")) << topic;
        EXPECT_THAT(read(viewer_, topic), ElementsAre("w/site/*")) << topic;
        EXPECT_THAT(read(monitor_, topic), ElementsAre("w/site/*")) << topic;
        for (const Member& other : {world_, viewer_, monitor_})
            EXPECT_THAT(written(other, topic), IsEmpty()) << topic;
    }
}

TEST_F(WrittenAndRead, KeepTheHostsOfASiteAmongThemselves) {
    for (const char* topic :
         {"CameraSilhouette", "SiteOrders", "ClockAnswer", "RegionOrder", "RegionMeshes"}) {
        EXPECT_THAT(written(site_, topic), ElementsAre("w/part/alice", "w/part/alice/*")) << topic;
        EXPECT_THAT(read(site_, topic), ElementsAre("w/part/alice", "w/part/alice/*")) << topic;
        for (const Member& other : {world_, viewer_, monitor_}) {
            EXPECT_THAT(written(other, topic), IsEmpty()) << topic;
            EXPECT_THAT(read(other, topic), IsEmpty()) << topic;
        }
    }
}

TEST_F(WrittenAndRead, GiveTheWorldToItsServer) {
    for (const char* topic : {"SitePlacement",
                              "SceneObject",
                              "SoftBody",
                              "SoftBodyState",
                              "Scenery",
                              "SceneState",
                              "PersonProxy",
                              "ObjectProxy",
                              "EditResult",
                              "SavedWorlds",
                              "WorldStatus"}) {
        EXPECT_THAT(written(world_, topic), ElementsAre("w/world")) << topic;
        for (const Member& other : {site_, viewer_, monitor_})
            EXPECT_THAT(written(other, topic), IsEmpty()) << topic;
        for (const Member& reader : {site_, world_, viewer_, monitor_})
            EXPECT_THAT(read(reader, topic), ElementsAre("w/world")) << topic;
    }
}

TEST_F(WrittenAndRead, GiveAViewerItsOwnPartition) {
    for (const char* topic : {"ViewerStatus", "StreamFeedback"}) {
        EXPECT_THAT(written(viewer_, topic), ElementsAre("w/viewer/bob")) << topic;
        for (const Member& other : {site_, world_, monitor_})
            EXPECT_THAT(written(other, topic), IsEmpty()) << topic;
        for (const Member& reader : {world_, viewer_, monitor_})
            EXPECT_THAT(read(reader, topic), ElementsAre("w/viewer/*")) << topic;
    }
    EXPECT_THAT(read(site_, "StreamFeedback"), ElementsAre("w/viewer/*"));
    EXPECT_THAT(read(site_, "ViewerStatus"), IsEmpty());
}

TEST_F(WrittenAndRead, WriteTheRightsIntoThePartitionOfCommands) {
    Member controller = monitor_;
    controller.rights = {Right::kRecord};
    for (const char* topic : {"SceneCommand", "SceneEdit"}) {
        EXPECT_THAT(written(viewer_, topic), ElementsAre("w/command/bob/push+grab")) << topic;
        EXPECT_THAT(written(controller, topic), ElementsAre("w/command/mona/record")) << topic;
        for (const Member& other : {site_, world_, monitor_})
            EXPECT_THAT(written(other, topic), IsEmpty()) << topic;
        for (const Member& other : {site_, viewer_})
            EXPECT_THAT(read(other, topic), IsEmpty()) << topic;
        for (const Member& reader : {world_, monitor_})
            EXPECT_THAT(read(reader, topic), ElementsAre("w/command/*")) << topic;
    }
    viewer_.rights = {};
    EXPECT_THAT(written(viewer_, "SceneCommand"), ElementsAre("w/command/bob/none"));
}

TEST_F(WrittenAndRead, LetOnlyMembersWithTheRightOrderRecordings) {
    EXPECT_THAT(written(viewer_, "RoomRecordOrder"), IsEmpty());
    viewer_.rights.add(Right::kRecord);
    EXPECT_THAT(written(viewer_, "RoomRecordOrder"), ElementsAre("w/command/bob/push+grab+record"));
    monitor_.rights = {Right::kRecord};
    EXPECT_THAT(written(monitor_, "RoomRecordOrder"), ElementsAre("w/command/mona/record"));
    EXPECT_THAT(read(site_, "RoomRecordOrder"), ElementsAre("w/command/*"));
    EXPECT_THAT(read(viewer_, "RoomRecordOrder"), IsEmpty());
}

TEST_F(WrittenAndRead, LetEverybodyBePresentUnderItsOwnName) {
    for (const char* topic : {"Presence", "RevokedKeys"}) {
        EXPECT_THAT(written(site_, topic), ElementsAre("w/site/alice"));
        EXPECT_THAT(written(world_, topic), ElementsAre("w/world"));
        EXPECT_THAT(written(viewer_, topic), ElementsAre("w/viewer/bob"));
        EXPECT_THAT(written(monitor_, topic), ElementsAre("w/monitor/mona"));
        for (const Member& reader : {site_, world_, viewer_, monitor_})
            EXPECT_THAT(read(reader, topic),
                        ElementsAre("w/world", "w/site/*", "w/viewer/*", "w/monitor/*"));
    }
}

TEST(Topics, HaveOneAuthorEach) {
    EXPECT_EQ(author_of("SiteMesh"), Author::kSite);
    EXPECT_EQ(author_of("Presence"), Author::kAll);
    EXPECT_EQ(author_of("Gossip"), std::nullopt);
}

}  // namespace
}  // namespace atrium::keys
