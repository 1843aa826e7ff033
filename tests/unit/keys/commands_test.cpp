#include "tools/keys/commands.hpp"

#include "core/keys/private_file.hpp"
#include "tests/unit/keys/a_world.hpp"
#include "tools/keys/find_store.hpp"
#include "tools/keys/listing.hpp"

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
using ::testing::HasSubstr;
using ::testing::Not;

class Commands : public ::testing::Test {
protected:
    Commands() {
        options_.keys = folder_ / "playroom.keys";
        Options first = options_;
        first.name = "playroom";
        made_ = value(init(first, kNow)).text;
        add_member("site", "alice");
        add_member("viewer", "bob");
    }
    std::string add_member(const std::string& kind,
                           const std::string& name,
                           std::optional<std::string> rights = {}) {
        Options options = options_;
        options.kind = kind;
        options.name = name;
        options.rights = std::move(rights);
        const auto outcome = add(options, kNow);
        return outcome ? outcome->text : outcome.error().message;
    }
    Options named(const std::string& name) const {
        Options options = options_;
        options.name = name;
        return options;
    }

    test::TemporaryFolder folder_;
    Options options_;
    std::string made_;
};

TEST_F(Commands, SayWhatComesNext) {
    EXPECT_THAT(made_, AllOf(HasSubstr("valid until 2037-01-12"), HasSubstr("a copy of it")));
    EXPECT_THAT(add_member("viewer", "eve", "edit,grab"),
                AllOf(HasSubstr("viewer eve of world playroom with the rights grab+edit, valid "
                                "until 2028-01-15"),
                      HasSubstr("atrium keys export eve -o eve.bundle --keys '")));
    EXPECT_THAT(add_member("world", ""), HasSubstr("world server of world playroom, valid"));
    EXPECT_THAT(add_member("monitor", "mona"), HasSubstr("with the rights none"));
    // as `list` shows them
    EXPECT_THAT(add_member("viewer", "tim", "push+grab"), HasSubstr("with the rights push+grab"));
}

TEST_F(Commands, NameWhatIsMissing) {
    EXPECT_THAT(add_member("", ""), HasSubstr("KIND is missing"));
    EXPECT_THAT(add_member("site", ""), HasSubstr("NAME is missing"));
    EXPECT_THAT(add_member("viever", "x"), HasSubstr("did you mean viewer?"));
    EXPECT_THAT(revoke(named(""), kNow).error().message, HasSubstr("NAME is missing"));
    EXPECT_THAT(export_bundle(named("alice"), kNow).error().message, HasSubstr("-o is missing"));
    Options printed = named("alice");
    printed.output = "-";
    EXPECT_THAT(export_bundle(printed, kNow).error().message, HasSubstr("-o -: keys are secret"));
    EXPECT_FALSE(std::filesystem::exists("-"));
    EXPECT_THAT(init(Options(), kNow).error().message, HasSubstr("WORLD is missing"));
}

TEST_F(Commands, ListAllMembers) {
    Options gone = named("bob");
    gone.reason = "left";
    value(revoke(gone, kNow));
    EXPECT_EQ(value(list(options_, kNow)).text,
              "World playroom\n"
              "NAME   KIND    RIGHTS     VALID UNTIL  STATE\n"
              "alice  site    -          2028-01-15   valid\n"
              "bob    viewer  push+grab  2028-01-15   revoked (left, 2027-01-15)\n");
    Options json = options_;
    json.json = true;
    EXPECT_EQ(value(list(json, kNow)).text,
              R"({
  "world": "playroom",
  "members": [
    {
      "name": "alice",
      "kind": "site",
      "valid_from": "2027-01-14T08:00:00Z",
      "valid_until": "2028-01-15T08:00:00Z",
      "state": "valid"
    },
    {
      "name": "bob",
      "kind": "viewer",
      "rights": "push+grab",
      "valid_from": "2027-01-14T08:00:00Z",
      "valid_until": "2028-01-15T08:00:00Z",
      "state": "revoked",
      "revoked_at": "2027-01-15T08:00:00Z",
      "reason": "left"
    }
  ]
}
)");
}

TEST_F(Commands, ExportABundleForItsOwnerOnly) {
    Options options = named("bob");
    options.output = folder_ / "bob.bundle";
    EXPECT_THAT(value(export_bundle(options, kNow)).text, HasSubstr("It is secret"));
    struct stat info {};
    ASSERT_EQ(::stat(options.output.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 07777U, 0600U);
    EXPECT_THAT(export_bundle(options, kNow).error().message, HasSubstr("--replace"));
    options.replace = true;
    value(export_bundle(options, kNow));

    Options look;
    look.bundle = options.output;
    const Outcome usable = value(check(look, kNow));
    EXPECT_EQ(usable.exit_code, 0);
    EXPECT_THAT(usable.text,
                AllOf(HasSubstr("viewer bob"),
                      HasSubstr("playroom"),
                      HasSubstr("push+grab"),
                      HasSubstr("2028-01-15T08:00:00Z (365 days)")));
    const Outcome late = value(check(look, kNow + 366 * kDay));
    EXPECT_EQ(late.exit_code, 1);
    EXPECT_THAT(late.text, HasSubstr("has expired"));
    ::chmod(options.output.c_str(), 0644);
    EXPECT_EQ(value(check(look, kNow)).exit_code, 1);
    look.bundle = folder_ / "none.bundle";
    EXPECT_EQ(check(look, kNow).error().kind, ErrorKind::kNotFound);
}

TEST_F(Commands, ExportNoBundleThatIsNotUsable) {
    Options options = named("bob");
    options.output = folder_ / "bob.bundle";
    EXPECT_FALSE(export_bundle(options, kNow + 366 * kDay));
    value(revoke(named("bob"), kNow));
    EXPECT_THAT(export_bundle(options, kNow).error().message,
                AllOf(HasSubstr("viewer bob of world playroom"), HasSubstr("renew bob")));
    EXPECT_FALSE(std::filesystem::exists(options.output));
}

TEST_F(Commands, TellHowOthersLearnOfARevocation) {
    EXPECT_THAT(value(revoke(named("bob"), kNow)).text,
                AllOf(HasSubstr("revoked viewer bob of world playroom (lost)"),
                      HasSubstr("when their bundles have the new list"),
                      HasSubstr("\n  atrium keys export alice -o alice.bundle --replace --keys '"),
                      Not(HasSubstr("export bob")),
                      Not(HasSubstr("tunnel")),
                      HasSubstr("renew bob")));
    Options world = options_;
    world.kind = "world";
    value(add(world, kNow));
    Options options = named("bob");
    options.rights = "all";
    EXPECT_THAT(value(renew(options, kNow)).text,
                AllOf(HasSubstr("with the rights add+remove+reset+push+grab+edit+save+record"),
                      HasSubstr("export bob -o bob.bundle --replace"),
                      HasSubstr("start that program again: a running one keeps its old key"),
                      HasSubstr("export playroom -o playroom.bundle --replace")));
    options.reason = "replaced";
    EXPECT_THAT(revoke(options, kNow).error().message, HasSubstr("must be one of lost, left"));
}

// Its new file tells the others to refuse its old key, and with it the running world server.
TEST_F(Commands, TellToStartARenewedWorldServerAgain) {
    Options world = options_;
    world.kind = "world";
    value(add(world, kNow));
    const std::string renewed = value(renew(named("playroom"), kNow)).text;
    EXPECT_THAT(renewed,
                AllOf(HasSubstr("export playroom -o playroom.bundle --replace"),
                      HasSubstr("start the world server again at once"),
                      Not(HasSubstr("Bring the new list"))));
    EXPECT_THAT(value(revoke(named("playroom"), kNow)).text,
                AllOf(HasSubstr("\n  atrium keys export alice -o alice.bundle --replace"),
                      HasSubstr("\n  atrium keys export bob -o bob.bundle --replace"),
                      Not(HasSubstr("export playroom")),
                      HasSubstr("renew playroom")));
}

TEST_F(Commands, CheckTheWholeStore) {
    Outcome outcome = value(check(options_, kNow));
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.text, HasSubstr("are sound; 2 members"));
    EXPECT_THAT(value(check(options_, kNow + 350 * kDay)).text,
                HasSubstr("expires soon (2028-01-15)"));
    ::chmod((options_.keys / "identity.key").c_str(), 0604);
    outcome = value(check(options_, kNow));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.text, HasSubstr("chmod 600"));
    Options none;
    none.keys = folder_ / "none.keys";
    EXPECT_EQ(check(none, kNow).error().kind, ErrorKind::kNotFound);
}

TEST_F(Commands, CheckABundleAlsoAgainstTheListOfTheStore) {
    Options options = named("bob");
    options.output = folder_ / "bob.bundle";
    value(export_bundle(options, kNow));
    options.bundle = options.output;
    EXPECT_EQ(value(check(options, kNow)).exit_code, 0);
    value(revoke(named("bob"), kNow));
    const Outcome outcome = value(check(options, kNow));
    EXPECT_EQ(outcome.exit_code, 1) << "although the bundle has the old list";
    EXPECT_THAT(outcome.text, HasSubstr("the key is revoked, says " + options_.keys.string()));
    options.keys = folder_ / "none.keys";
    EXPECT_EQ(check(options, kNow).error().kind, ErrorKind::kNotFound) << "it was named";
    Options first = options;
    first.keys = folder_ / "other.keys";
    first.name = "playroom";
    value(init(first, kNow));
    options.keys = first.keys;
    EXPECT_EQ(value(check(options, kNow)).exit_code, 0) << "of another store it knows nothing";
}

TEST(FindStore, TakesTheOnlyOne) {
    const test::TemporaryFolder folder;
    EXPECT_EQ(find_store("", folder / "").error().kind, ErrorKind::kNotFound);
    std::filesystem::create_directory(folder / "b.keys");
    std::ofstream(folder / "file.keys") << "no folder";
    EXPECT_EQ(value(find_store("", folder / "")).filename(), "b.keys");
    EXPECT_EQ(value(find_store("x", folder / "")), "x");
    std::filesystem::create_directory(folder / "a.keys");
    EXPECT_THAT(find_store("", folder / "").error().message, HasSubstr("a.keys, b.keys"));
}

}  // namespace
}  // namespace atrium::keys_tool
