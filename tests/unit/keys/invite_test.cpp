#include "core/keys/bundle.hpp"
#include "core/keys/store.hpp"
#include "tests/unit/keys/a_world.hpp"
#include "tools/keys/commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

namespace atrium::keys_tool {
namespace {

using keys::testing::kDay;
using keys::testing::kNow;
using keys::testing::value;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class Invite : public ::testing::Test {
protected:
    Invite() {
        Options options;
        options.keys = folder_ / "playroom.keys";
        options.name = "playroom";
        value(init(options, kNow));
    }
    Options inviting(const std::string& kind, const std::string& name) const {
        Options options;
        options.keys = folder_ / "playroom.keys";
        options.kind = kind;
        options.name = name;
        options.output = folder_ / (name.empty() ? "world.invitation" : name + ".invitation");
        options.hub = "studio.example.org:4711";
        return options;
    }
    std::string said(const Options& options, Timestamp now = kNow) {
        const auto outcome = invite(options, now);
        if (!outcome) return "failed: " + outcome.error().message;
        EXPECT_EQ(outcome->exit_code, 0);
        return outcome->text;
    }
    std::vector<std::string> members() {
        Options options;
        options.keys = folder_ / "playroom.keys";
        const auto store = value(open_store(options, keys::KeyStore::Access::kRead));
        std::vector<std::string> lines;
        for (const keys::Entry& entry : value(store.entries(kNow)))
            lines.push_back(std::string(keys::kind_text(entry.member.kind)) + " " +
                            entry.member.name + " " + keys::rights_text(entry.member.rights));
        return lines;
    }
    std::vector<std::string> places_in(const std::filesystem::path& file) {
        std::vector<std::string> names;
        const auto bundle = value(keys::read_bundle(file));
        if (bundle.tunnel)
            for (const keys::Place& place : bundle.tunnel->places) names.push_back(place.name);
        return names;
    }

    test::TemporaryFolder folder_;
};

TEST_F(Invite, AddsTheMemberAndTheWorldServer) {
    const Options bob = inviting("viewer", "bob");
    EXPECT_THAT(said(bob),
                AllOf(HasSubstr("added world server of world playroom, valid until 2028-01-15"),
                      HasSubstr("added viewer bob of world playroom with the rights push+grab")));
    EXPECT_THAT(members(), ElementsAre("viewer bob push+grab", "world playroom none"));
    struct stat info {};
    ASSERT_EQ(::stat(bob.output.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 07777U, 0600U);
    const auto bundle = value(keys::read_bundle(bob.output));
    EXPECT_TRUE(keys::check(bundle, kNow));
    EXPECT_EQ(bundle.member.name, "bob");
    ASSERT_TRUE(bundle.tunnel);
    EXPECT_EQ(bundle.tunnel->hub, "studio.example.org:4711");
    EXPECT_THAT(places_in(bob.output), ElementsAre("playroom", "bob"));
}

TEST_F(Invite, AddsNobodyTwice) {
    said(inviting("viewer", "bob"));
    Options again = inviting("viewer", "bob");
    again.replace = true;
    again.hub.clear();
    EXPECT_THAT(said(again), AllOf(HasSubstr("wrote "), Not(HasSubstr("added"))));
    Options alice = inviting("site", "alice");
    alice.hub.clear();
    EXPECT_THAT(said(alice), AllOf(HasSubstr("added site alice"), Not(HasSubstr("added world"))));
    EXPECT_THAT(members(),
                ElementsAre("site alice none", "viewer bob push+grab", "world playroom none"));
    EXPECT_THAT(places_in(alice.output), ElementsAre("playroom", "bob", "alice"));
    EXPECT_EQ(value(keys::read_bundle(alice.output)).tunnel->hub, "studio.example.org:4711");
}

TEST_F(Invite, TakesTheWorldServerThatIsThere) {
    Options hall = inviting("world", "hall");
    value(add(hall, kNow));
    EXPECT_THAT(said(inviting("viewer", "bob")), Not(HasSubstr("added world")));
    EXPECT_THAT(places_in(folder_ / "bob.invitation"), ElementsAre("hall", "bob"));
}

TEST_F(Invite, NamesTheCommandsOfASpoke) {
    const std::string text = said(inviting("viewer", "bob"));
    EXPECT_THAT(
        text,
        AllOf(HasSubstr("It is secret: bring it only to bob"),
              HasSubstr("  sudo atrium tunnel up bob.invitation\n"
                        "  atrium viewer --join bob.invitation\n"),
              HasSubstr("The world server's host, studio.example.org, must"),
              HasSubstr("UDP port 4711"),
              HasSubstr("  atrium keys export playroom -o playroom.invitation --replace --keys '" +
                        (folder_ / "playroom.keys").string() + "'\n"),
              HasSubstr("  sudo atrium tunnel up playroom.invitation\n"
                        "  atrium world --config FILE --join playroom.invitation\n")));
    EXPECT_THAT(said(inviting("site", "alice")),
                HasSubstr("  atrium site --config FILE --join alice.invitation\n"));
    EXPECT_THAT(said(inviting("monitor", "mona")),
                HasSubstr("  atrium monitor --join mona.invitation\n"));
    for (const char* file : {"bob.invitation", "alice.invitation"}) {
        const auto bundle = value(keys::read_bundle(folder_ / file));
        EXPECT_THAT(text, Not(HasSubstr(bundle.tunnel->private_key)));
    }
}

TEST_F(Invite, NamesTheCommandsOfTheHub) {
    const std::string text = said(inviting("world", ""));
    EXPECT_THAT(text,
                AllOf(HasSubstr("added world server of world playroom"),
                      HasSubstr("On the host of the world server, studio.example.org"),
                      HasSubstr("UDP port 4711"),
                      HasSubstr("  sudo atrium tunnel up world.invitation\n"
                                "  atrium world --config FILE --join world.invitation\n"),
                      Not(HasSubstr("atrium keys export"))));
    EXPECT_TRUE(value(keys::read_bundle(folder_ / "world.invitation")).tunnel->is_hub());
}

// The next command writes what the first one says.
TEST_F(Invite, LeavesTheHubsFileToExport) {
    said(inviting("viewer", "bob"));
    Options hub = inviting("world", "playroom");
    value(export_bundle(hub, kNow));
    EXPECT_THAT(places_in(hub.output), ElementsAre("playroom", "bob"));
    EXPECT_TRUE(value(keys::read_bundle(hub.output)).tunnel->is_hub());
}

TEST_F(Invite, ReplacesAFileOnlyIfToldSo) {
    Options bob = inviting("viewer", "bob");
    std::ofstream(bob.output) << "mine";
    EXPECT_THAT(said(bob), AllOf(HasSubstr("exists already"), HasSubstr("--replace")));
    std::string kept;
    std::ifstream(bob.output) >> kept;
    EXPECT_EQ(kept, "mine");
    EXPECT_THAT(members(), ElementsAre());
    bob.replace = true;
    EXPECT_THAT(said(bob), HasSubstr("wrote "));
    EXPECT_THAT(places_in(bob.output), ElementsAre("playroom", "bob"));
}

TEST_F(Invite, DoesNotChangeRights) {
    said(inviting("viewer", "bob"));
    Options bob = inviting("viewer", "bob");
    bob.replace = true;
    bob.rights = "all";
    const auto refused = invite(bob, kNow);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("viewer bob of world playroom has other rights"),
                      HasSubstr("`atrium keys renew bob --rights all --keys '")));
    EXPECT_THAT(members(), ElementsAre("viewer bob push+grab", "world playroom none"));
    bob.rights = "grab,push";
    EXPECT_THAT(said(bob), HasSubstr("wrote "));
}

TEST_F(Invite, NamesWhatIsMissingOrWrong) {
    Options bob = inviting("viewer", "bob");
    bob.hub.clear();
    EXPECT_THAT(said(bob), HasSubstr("--hub HOST"));
    bob.hub = "a b";
    EXPECT_THAT(said(bob), HasSubstr("hub: 'a b' must be HOST or HOST:PORT"));
    EXPECT_THAT(said(inviting("", "bob")), HasSubstr("KIND is missing"));
    EXPECT_THAT(said(inviting("viewer", "")), HasSubstr("NAME is missing"));
    EXPECT_FALSE(std::filesystem::exists(bob.output));
    said(inviting("viewer", "eve"));
    EXPECT_THAT(said(inviting("site", "eve")),
                AllOf(HasSubstr("the name eve is taken by a viewer"), Not(HasSubstr("--replace"))));
    bob.hub = "http://studio";
    EXPECT_THAT(said(bob), HasSubstr("must be HOST or HOST:PORT, with the name or IPv4 address"));
    Options printed = inviting("viewer", "tim");
    printed.output = "-";
    EXPECT_THAT(said(printed), HasSubstr("-o -: keys are secret"));
    EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST_F(Invite, GivesARevokedMemberNoPlace) {
    Options bob = inviting("viewer", "bob");
    said(bob);
    value(revoke(bob, kNow));
    bob.replace = true;
    EXPECT_THAT(said(bob), AllOf(HasSubstr("is revoked"), HasSubstr("renew bob")));
    Options hub = inviting("world", "playroom");
    value(export_bundle(hub, kNow));
    EXPECT_THAT(places_in(hub.output), ElementsAre("playroom"));
    value(renew(bob, kNow));
    EXPECT_THAT(said(bob), HasSubstr("wrote "));
}

// Its tunnel key may be in other hands: it gets a new one by another invitation only.
TEST_F(Invite, TellsThatARevokedMemberHasNoTunnelAnyMore) {
    Options bob = inviting("viewer", "bob");
    said(bob);
    const std::string old_key = value(keys::read_bundle(bob.output)).tunnel->private_key;
    const std::string cure = "atrium keys invite viewer bob --replace --keys '";
    EXPECT_THAT(value(revoke(bob, kNow)).text,
                AllOf(HasSubstr("new place in the tunnel: " + cure), HasSubstr("renew bob")));
    EXPECT_THAT(value(renew(bob, kNow)).text,
                AllOf(HasSubstr("It has no tunnel: bob has no place"), HasSubstr(cure)));
    bob.replace = true;
    EXPECT_THAT(value(export_bundle(bob, kNow)).text,
                AllOf(HasSubstr("It has no tunnel: bob has no place"), HasSubstr(cure)));
    Options look;
    look.bundle = bob.output;
    EXPECT_THAT(value(check(look, kNow)).text, HasSubstr("tunnel       none"));
    EXPECT_THAT(said(bob), HasSubstr("wrote "));
    EXPECT_NE(value(keys::read_bundle(bob.output)).tunnel->private_key, old_key);
    EXPECT_THAT(value(export_bundle(bob, kNow)).text, Not(HasSubstr("no tunnel")));
    EXPECT_THAT(value(check(look, kNow)).text,
                AllOf(HasSubstr("tunnel       10."),
                      HasSubstr(".2, through the hub studio.example.org:4711")));
}

TEST_F(Invite, CheckTellsThePlaceOfTheHub) {
    said(inviting("viewer", "bob"));
    Options hub = inviting("world", "playroom");
    value(export_bundle(hub, kNow));
    hub.bundle = hub.output;
    EXPECT_THAT(
        value(check(hub, kNow)).text,
        HasSubstr(".1, the hub of 1 other place, which they reach at studio.example.org:4711"));
}

// A new tunnel key needs both ends.
TEST_F(Invite, RenewalOfAPlaceNamesTheCommandsOfBothEnds) {
    const Options bob = inviting("viewer", "bob");
    said(bob);
    EXPECT_THAT(value(renew(bob, kNow)).text,
                AllOf(HasSubstr("export bob -o bob.invitation --replace"),
                      HasSubstr("run `sudo atrium tunnel up bob.invitation` there, and start"),
                      HasSubstr("export playroom -o playroom.invitation --replace"),
                      HasSubstr("  sudo atrium tunnel up playroom.invitation\n"),
                      Not(HasSubstr("no tunnel"))));
}

TEST_F(Invite, RefusesAMemberWhoseKeyHasExpired) {
    Options bob = inviting("viewer", "bob");
    said(bob);
    bob.replace = true;
    EXPECT_THAT(said(bob, kNow + 366 * kDay), HasSubstr("has expired"));
}

}  // namespace
}  // namespace atrium::keys_tool
