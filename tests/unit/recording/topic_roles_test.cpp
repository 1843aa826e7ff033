#include "core/recording/topic_roles.hpp"

#include "core/recording/renamed.hpp"
#include "tests/unit/recording/recording_samples.hpp"

namespace atrium::recording {
namespace {

using namespace recording::testing;

template <typename Message>
std::optional<std::string> site_in_key(const Message& message) {
    const Recorded sample = recorded(message, kBegin);
    return site_of(*sample.topic, value(sample.topic->key_of({sample.kind, kBegin, sample.cdr})));
}

TEST(SiteOf, KnowsWhatBelongsToASite) {
    EXPECT_EQ(site_in_key(description("alice")), "alice");
    EXPECT_EQ(site_in_key(mesh("alice", 1)), "alice");
    EXPECT_EQ(site_in_key(texture("alice", 1, 1)), "alice");
    EXPECT_EQ(site_in_key(placement("alice", 1.0)), "alice");
    bus::CameraNodeStatus status;
    status.site = "alice";
    status.host = "front";
    EXPECT_EQ(site_in_key(status), "alice");
    bus::StreamFeedback feedback;
    feedback.viewer = "vera";
    feedback.site = "alice";
    EXPECT_EQ(site_in_key(feedback), "alice");
}

TEST(SiteOf, KnowsTheProgramsOfASite) {
    EXPECT_EQ(site_in_key(presence(bus::ProgramKind::kSiteNode, "lab.alice")), "lab.alice");
    EXPECT_EQ(site_in_key(presence(bus::ProgramKind::kCameraNode, "alice.front")), "alice");
    EXPECT_EQ(site_in_key(presence(bus::ProgramKind::kRegionNode, "lab.alice.back")), "lab.alice");
    EXPECT_EQ(site_in_key(presence(bus::ProgramKind::kWorldServer, "alice")), std::nullopt);
    EXPECT_EQ(site_in_key(presence(bus::ProgramKind::kViewer, "alice")), std::nullopt);
}

TEST(SiteOf, IsNothingForWhatBelongsToTheWorld) {
    EXPECT_EQ(site_in_key(state(1)), std::nullopt);
    EXPECT_EQ(site_in_key(object(1, 1.0)), std::nullopt);
    EXPECT_EQ(site_in_key(command("alice")), std::nullopt);
}

TEST(TopicRoles, AreThoseOfTheirQos) {
    const auto is = [](const char* name, auto role) { return role(*bus::find_raw_topic(name)); };
    for (const char* name : {"SiteDescription",
                             "SitePlacement",
                             "SceneObject",
                             "SoftBody",
                             "Scenery",
                             "ObjectProxy",
                             "SavedWorlds",
                             "Presence"})
        EXPECT_TRUE(is(name, is_kept)) << name;
    for (const char* name : {"SceneCommand", "SceneEdit", "EditResult"}) {
        EXPECT_TRUE(is(name, is_command)) << name;
        EXPECT_FALSE(is(name, is_kept)) << name;
    }
    for (const char* name : {"SiteMesh", "CameraTexture"})
        EXPECT_TRUE(is(name, is_of_people)) << name;
    EXPECT_FALSE(is("SceneState", is_of_people));
}

// The renamed sample, and whether renamed_key tells its key.
template <typename Message>
Message renamed_to(const Message& message, const Names& names, const Places& places = {}) {
    const Recorded sample = recorded(message, kBegin);
    const bus::RawSample raw{sample.kind, kBegin, sample.cdr};
    const auto cdr = value(renamed(*sample.topic, raw, names, places));
    EXPECT_EQ(value(sample.topic->key_of({sample.kind, kBegin, cdr})),
              renamed_key(*sample.topic, value(sample.topic->key_of(raw)), names));
    // Its end has the key of the sample.
    const Recorded end = recorded(message, kBegin, bus::RawKind::kDisposed);
    const auto end_cdr = value(renamed(*end.topic, {end.kind, kBegin, end.cdr}, names, places));
    EXPECT_EQ(value(sample.topic->key_of({end.kind, kBegin, end_cdr})),
              value(sample.topic->key_of({sample.kind, kBegin, cdr})));
    return value(bus::from_raw<Message>({sample.kind, kBegin, cdr}));
}

TEST(Renamed, GivesSitesOtherNames) {
    const Names names{{"alice", "anna"}, {"0", "zero"}};
    EXPECT_EQ(renamed_to(description("alice"), names).site, "anna");
    EXPECT_EQ(renamed_to(description("alice"), names).cameras.size(), 2u);
    EXPECT_EQ(renamed_to(mesh("alice", 3), names).draco, mesh("alice", 3).draco);
    EXPECT_EQ(renamed_to(texture("alice", 1, 3), names).site, "anna");
    EXPECT_EQ(renamed_to(texture("bob", 1, 3), names).site, "bob");
    EXPECT_EQ(renamed_to(presence(bus::ProgramKind::kSiteNode, "alice"), names).name, "anna");
    EXPECT_EQ(renamed_to(presence(bus::ProgramKind::kSiteNode, "0"), names).name, "zero");
    EXPECT_EQ(renamed_to(presence(bus::ProgramKind::kCameraNode, "alice.front"), names).name,
              "anna.front");
    bus::StreamFeedback feedback;
    feedback.viewer = "alice";  // a viewer of the same name is another program
    feedback.site = "alice";
    EXPECT_EQ(renamed_to(feedback, names).site, "anna");
    EXPECT_EQ(renamed_to(feedback, names).viewer, "alice");
}

TEST(Renamed, SwapsNames) {
    const Names names{{"alice", "bob"}, {"bob", "alice"}};
    EXPECT_EQ(renamed_to(mesh("alice", 1), names).site, "bob");
    EXPECT_EQ(renamed_to(mesh("bob", 1), names).site, "alice");
}

TEST(Renamed, MovesSitesByTheirNewNames) {
    geometry::RigidTransform place;
    place.translation = {1.0, 2.0, 0.0};
    const Names names{{"alice", "anna"}};
    const auto moved = renamed_to(placement("alice", 5.0), names, {{"anna", place}});
    EXPECT_EQ(moved.world_from_site.translation, place.translation);
    const auto other = renamed_to(placement("bob", 5.0), names, {{"anna", place}});
    EXPECT_EQ(other.world_from_site.translation.x(), 5.0);
}

}  // namespace
}  // namespace atrium::recording
