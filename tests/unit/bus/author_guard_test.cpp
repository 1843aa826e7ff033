#include "core/bus/author_guard.hpp"

#include "core/bus/topics.hpp"
#include "tests/unit/bus/all_messages.hpp"
#include "tests/unit/bus/random_messages.hpp"

#include <gtest/gtest.h>

namespace atrium::bus {
namespace {

using keys::Kind;
using keys::PartitionAuthor;

TEST(MayWrite, LetsEveryMemberWriteItsOwnInstances) {
    for (const Kind kind : keys::kKinds) {
        const PartitionAuthor author{"ann", kind, {}};
        EXPECT_TRUE(may_write(author, {"ann", {}}));
        EXPECT_TRUE(may_write(author, {"ann", kind}));
        for (const char* other :
             {"", "an", "anna", "Ann", "ann ", "bob", ".ann", "x.ann", "bob.ann"})
            EXPECT_FALSE(may_write(author, {other, {}})) << other;
    }
}

TEST(MayWrite, LetsASiteWriteThoseOfItsHosts) {
    const PartitionAuthor ann{"ann", Kind::kSite, {}};
    EXPECT_TRUE(may_write(ann, {"ann.left", {}}));
    EXPECT_TRUE(may_write(ann, {"ann.left", Kind::kSite}));
    EXPECT_TRUE(may_write(ann, {"ann.left.upper", {}}));
    for (const char* other : {"anna.left", "anna", "ann-left", "annx.left", "an.left", "left.ann"})
        EXPECT_FALSE(may_write(ann, {other, {}})) << other;
    EXPECT_FALSE(may_write({"anna", Kind::kSite, {}}, {"ann.left", {}}));
    EXPECT_FALSE(may_write({"ann.left", Kind::kSite, {}}, {"ann", {}}));
}

// The key store lets a viewer bob.left exist beside the viewer bob.
TEST(MayWrite, LetsNoOtherKindWriteANameThatBeginsWithItsOwn) {
    for (const Kind kind : {Kind::kViewer, Kind::kWorld, Kind::kMonitor}) {
        EXPECT_FALSE(may_write({"bob", kind, {}}, {"bob.left", {}}));
        EXPECT_FALSE(may_write({"bob", kind, {}}, {"bob.left", kind}));
    }
    EXPECT_FALSE(may_write({"bob", std::nullopt, keys::Rights::all()}, {"bob.left", {}}));
    EXPECT_TRUE(may_write({"bob", std::nullopt, {}}, {"bob", {}}));
}

TEST(MayWrite, LetsNobodyBePresentAsAnotherKind) {
    for (const Kind author : keys::kKinds)
        for (const Kind claimed : keys::kKinds)
            EXPECT_EQ(may_write({"ann", author, {}}, {"ann", claimed}), author == claimed);
    // who writes commands may be a viewer or a monitor
    for (const Kind claimed : keys::kKinds)
        EXPECT_FALSE(may_write({"ann", std::nullopt, {}}, {"ann", claimed}));
    EXPECT_FALSE(may_write({"ann", Kind::kViewer, {}}, {"ann.left", Kind::kSite}));
}

TEST(KeyKind, IsThatOfTheProgram) {
    EXPECT_EQ(key_kind(ProgramKind::kWorldServer), Kind::kWorld);
    EXPECT_EQ(key_kind(ProgramKind::kViewer), Kind::kViewer);
    EXPECT_EQ(key_kind(ProgramKind::kOther), Kind::kMonitor);
    for (const ProgramKind kind :
         {ProgramKind::kSiteNode, ProgramKind::kCameraNode, ProgramKind::kRegionNode})
        EXPECT_EQ(key_kind(kind), Kind::kSite);
}

TEST(ClaimOf, IsTheKeyFieldWithTheName) {
    SiteMesh mesh;
    mesh.site = "alice";
    EXPECT_EQ(claim_of(mesh).name, "alice");
    EXPECT_EQ(claim_of(mesh).kind, std::nullopt);
    StreamFeedback feedback;
    feedback.viewer = "bob";
    feedback.site = "alice";
    EXPECT_EQ(claim_of(feedback).name, "bob");
    SceneCommand command;
    command.sender = "bob";
    EXPECT_EQ(claim_of(command).name, "bob");
    RoomRecordOrder order;
    order.sender = "mona";
    order.site = "alice";
    EXPECT_EQ(claim_of(order).name, "mona");
    RoomRecording recording;
    recording.sender = "mona";
    recording.site = "alice";
    EXPECT_EQ(claim_of(recording).name, "alice");
}

TEST(ClaimOf, APresenceHasAKind) {
    Presence presence;
    presence.name = "alice.left";
    presence.kind = ProgramKind::kCameraNode;
    EXPECT_EQ(claim_of(presence).name, "alice.left");
    EXPECT_EQ(claim_of(presence).kind, Kind::kSite);
    presence.kind = ProgramKind::kWorldServer;
    EXPECT_EQ(claim_of(presence).kind, Kind::kWorld);
}

template <typename Message>
class EveryClaim : public ::testing::Test {};
TYPED_TEST_SUITE(EveryClaim, testing::AllMessages);

// Cyclone has the key of an instance only: other fields are empty there.
TYPED_TEST(EveryClaim, ComesFromTheKeyAlone) {
    if (keys::author_of(Topic<TypeParam>::kName) == keys::Author::kWorld) return;  // not guarded
    testing::Random random(9);
    for (int round = 0; round < 20; ++round) {
        const auto message = testing::random_message<TypeParam>(random);
        WireOf<TypeParam> key{};
        key_to_wire(message, key);
        const auto claim = claim_of_key<TypeParam>(&key);
        ASSERT_TRUE(claim);
        EXPECT_FALSE(claim->name.empty());
        EXPECT_EQ(claim->name, claim_of(message).name);
        EXPECT_EQ(claim->kind, claim_of(message).kind);
    }
}

TEST(Authors, RemembersThoseWhoWrote) {
    Authors authors("w", "SiteMesh");
    EXPECT_FALSE(authors.find(7));
    authors.add(7, {"alice", Kind::kSite, {}});
    authors.add(8, {"bob", std::nullopt, {keys::Right::kPush}});
    EXPECT_EQ(authors.find(7)->name, "alice");
    EXPECT_EQ(authors.find(8)->rights, keys::Rights{keys::Right::kPush});
    EXPECT_FALSE(authors.find(9));
    authors.add(7, {"anna", Kind::kSite, {}});
    EXPECT_EQ(authors.find(7)->name, "anna");
}

}  // namespace
}  // namespace atrium::bus
