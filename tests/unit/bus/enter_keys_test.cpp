#include "core/bus/bus_options.hpp"
#include "core/keys/private_file.hpp"
#include "core/keys/store.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>

namespace atrium::bus {
namespace {

namespace fs = std::filesystem;
using keys::Kind;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::chrono::hours kOneDay{24};

// Sets a variable of the environment, or none, until the end of the scope.
class Variable {
public:
    explicit Variable(const char* name) : name_(name) {
        if (const char* value = std::getenv(name)) before_ = value;
        ::unsetenv(name);
    }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;
    ~Variable() {
        if (before_) {
            ::setenv(name_, before_->c_str(), 1);
        } else {
            ::unsetenv(name_);
        }
    }
    void set(const std::string& value) { ::setenv(name_, value.c_str(), 1); }

private:
    const char* name_;
    std::optional<std::string> before_;
};

// Bundles of a world "playroom", each in the file NAME.bundle, and an invitation for bob.
class Bundles {
public:
    explicit Bundles(const fs::path& folder, Timestamp now = Timestamp::now()) : folder_(folder) {
        auto store = keys::KeyStore::create(folder / "store.keys", "playroom", 3650, now).value();
        for (const keys::Member& member :
             {keys::Member{"playroom", Kind::kWorld, "hall", {}},
              keys::Member{"playroom", Kind::kViewer, "bob", {keys::Right::kPush}},
              keys::Member{"playroom", Kind::kSite, "alice", {}},
              keys::Member{"playroom", Kind::kMonitor, "mona", {}}}) {
            store.add(member, 365, now).value();
            write(store, member.name, member.name + ".bundle");
        }
        EXPECT_TRUE(store.add_place("bob", "studio.example.org:51820"));
        write(store, "bob", "bob.invitation");
    }
    std::string file(const std::string& name) const { return (folder_ / name).string(); }

private:
    void write(const keys::KeyStore& store, const std::string& name, const std::string& file) {
        const std::string text = keys::bundle_text(store.bundle(name).value());
        EXPECT_TRUE(keys::write_private_file(folder_ / file, text, keys::Existing::kKeep));
    }
    fs::path folder_;
};

class EnterKeys : public ::testing::Test {
protected:
    // Made once: no test changes them.
    static const Bundles& bundles() {
        static const test::TemporaryFolder folder;
        static const Bundles all(folder / "");
        return all;
    }
    // The member whose keys were entered, or "none", or the error.
    std::string entered() {
        const auto done = enter_keys(options_);
        if (!done) return done.error().message;
        return options_.keys ? options_.keys->member.name : "none";
    }
    Error error_of_entering() {
        const auto done = enter_keys(options_);
        EXPECT_FALSE(options_.keys);
        return done ? Error{ErrorKind::kInternal, "no error"} : done.error();
    }
    // A folder with credentials of systemd: the bundle of this member, or none.
    std::string credentials_of(const std::string& name) {
        const fs::path credentials = folder_ / ("credentials." + name);
        fs::create_directory(credentials);
        if (!name.empty()) fs::copy_file(bundles().file(name + ".bundle"), credentials / "bundle");
        return credentials.string();
    }

    test::TemporaryFolder folder_;
    Variable security_{"ATRIUM_SECURITY"};
    Variable credentials_{"CREDENTIALS_DIRECTORY"};
    BusOptions options_;
};

TEST_F(EnterKeys, DoesNothingWithoutABundle) {
    EXPECT_EQ(entered(), "none");
    EXPECT_EQ(options_.world, BusOptions().world);
    EXPECT_EQ(options_.security, "");
    credentials_.set(credentials_of(""));
    EXPECT_EQ(entered(), "none");
    std::string name = "eve";
    EXPECT_TRUE(enter_keys(options_, Kind::kViewer, name));
    EXPECT_EQ(name, "eve");
}

TEST_F(EnterKeys, TakesTheWorldOfTheKeys) {
    options_.security = bundles().file("bob.bundle");
    EXPECT_EQ(entered(), "bob");
    EXPECT_EQ(options_.world, "playroom");
    EXPECT_EQ(options_.security, bundles().file("bob.bundle"));
    EXPECT_EQ(options_.keys->member.rights, keys::Rights{keys::Right::kPush});
    EXPECT_EQ(options_.network, BusOptions().network);
    // keys that are there are not read again
    options_.security = "/no/such/file";
    EXPECT_EQ(entered(), "bob");
}

TEST_F(EnterKeys, PrefersTheOptionAndThenTheVariable) {
    credentials_.set(credentials_of("alice"));
    EXPECT_EQ(entered(), "alice");
    options_ = {};
    security_.set(bundles().file("mona.bundle"));
    EXPECT_EQ(entered(), "mona");
    options_ = {};
    options_.security = bundles().file("bob.bundle");
    EXPECT_EQ(entered(), "bob");
}

// A script whose own variable is not set must not open the world.
TEST_F(EnterKeys, RefusesAnEmptyVariable) {
    security_.set("");
    for (const std::string& credentials : {std::string(), credentials_of("alice")}) {
        if (!credentials.empty()) credentials_.set(credentials);
        const Error error = error_of_entering();
        EXPECT_EQ(error.kind, ErrorKind::kConfiguration);
        EXPECT_THAT(error.message,
                    AllOf(HasSubstr("ATRIUM_SECURITY: "),
                          HasSubstr("is empty: give a bundle"),
                          HasSubstr("`none` for an open world")));
    }
    std::string name;
    EXPECT_FALSE(enter_keys(options_, Kind::kViewer, name));
    options_.security = bundles().file("bob.bundle");
    EXPECT_EQ(entered(), "bob") << "the option counts before the variable";
}

TEST_F(EnterKeys, RefusesEmptyOptionsWithTheirPlace) {
    config::OptionSet set;
    declare(options_, set);
    for (const std::string key : {"bus.security", "bus.join"}) {
        const auto given = set.set(key, "", "--" + key);
        ASSERT_FALSE(given) << key;
        EXPECT_EQ(given.error().kind, ErrorKind::kConfiguration);
        EXPECT_THAT(given.error().message, HasSubstr("--" + key + ": is empty: give a"));
        const std::string text = "[bus]\nworld = \"playroom\"\n" + key.substr(4) + " = \"\"\n";
        auto reader = config::TableReader::parse(text, "site.toml").value();
        set.read_file(reader);
        const auto read = reader.finish();
        ASSERT_FALSE(read) << key;
        EXPECT_EQ(read.error().kind, ErrorKind::kConfiguration);
        EXPECT_THAT(read.error().message, HasSubstr("site.toml:3: " + key + ": is empty: give a"));
    }
    EXPECT_THAT(set.set("bus.security", "", "--bus.security").error().message,
                HasSubstr("`none` for an open world"));
    EXPECT_TRUE(set.set("bus.security", "none", "--bus.security"));
    auto absent = config::TableReader::parse("[bus]\nworld = \"playroom\"\n", "site.toml").value();
    set.read_file(absent);
    EXPECT_TRUE(absent.finish());
}

TEST_F(EnterKeys, NamesTheVariableInErrors) {
    const auto message_with = [this](const std::string& file) {
        security_.set(file);
        options_ = {};
        return error_of_entering().message;
    };
    EXPECT_THAT(message_with((folder_ / "none.bundle").string()),
                AllOf(HasSubstr("ATRIUM_SECURITY: "), HasSubstr("none.bundle: cannot be read")));
    const fs::path file = folder_ / "x.bundle";
    fs::copy_file(bundles().file("bob.bundle"), file);
    ::chmod(file.c_str(), 0644);
    EXPECT_THAT(message_with(file.string()), HasSubstr("ATRIUM_SECURITY: " + file.string() + ": "));
    ::chmod(file.c_str(), 0600);
    fs::resize_file(file, 300);
    EXPECT_THAT(message_with(file.string()), HasSubstr("ATRIUM_SECURITY: " + file.string() + ": "));
    security_.set(bundles().file("bob.bundle"));
    options_.world = "studio";
    EXPECT_THAT(error_of_entering().message, HasSubstr("ATRIUM_SECURITY: "));
    options_ = {};
    std::string name;
    EXPECT_THAT(enter_keys(options_, Kind::kSite, name).error().message,
                HasSubstr("ATRIUM_SECURITY: "));
    options_ = {};
    name = "eve";
    EXPECT_THAT(enter_keys(options_, Kind::kViewer, name).error().message,
                HasSubstr("ATRIUM_SECURITY: "));
}

TEST_F(EnterKeys, IsTurnedOffByNone) {
    credentials_.set(credentials_of("alice"));
    security_.set("none");
    EXPECT_EQ(entered(), "none");
    security_.set(bundles().file("bob.bundle"));
    options_.security = "none";
    EXPECT_EQ(entered(), "none");
    EXPECT_EQ(options_.world, BusOptions().world);
}

TEST_F(EnterKeys, RemembersTheAbsolutePath) {
    const fs::path before = fs::current_path();
    fs::current_path(fs::path(bundles().file("bob.bundle")).parent_path());
    options_.security = "bob.bundle";
    EXPECT_EQ(entered(), "bob");
    fs::current_path(before);
    EXPECT_TRUE(fs::path(options_.security).is_absolute());
    EXPECT_TRUE(fs::equivalent(options_.security, bundles().file("bob.bundle")));
}

TEST_F(EnterKeys, RefusesAnotherWorld) {
    options_.security = bundles().file("bob.bundle");
    options_.world = "studio";
    const Error error = error_of_entering();
    EXPECT_EQ(error.kind, ErrorKind::kConfiguration);
    EXPECT_THAT(error.message,
                AllOf(HasSubstr("bus.security: "),
                      HasSubstr("keys of the world 'playroom'"),
                      HasSubstr("--world is 'studio'")));
    EXPECT_EQ(options_.world, "studio");
    for (const std::string& world : {std::string("playroom"), std::string(), BusOptions().world}) {
        options_.world = world;
        options_.keys.reset();
        EXPECT_EQ(entered(), "bob") << world;
    }
}

TEST_F(EnterKeys, RefusesAFileThatIsMissing) {
    options_.security = (folder_ / "none.bundle").string();
    const Error error = error_of_entering();
    EXPECT_EQ(error.kind, ErrorKind::kNotFound);
    EXPECT_THAT(error.message, AllOf(HasSubstr("bus.security: "), HasSubstr("none.bundle")));
    options_ = {};
    security_.set((folder_ / "none.bundle").string());
    EXPECT_EQ(error_of_entering().kind, ErrorKind::kNotFound);
}

TEST_F(EnterKeys, RefusesAFileThatOthersCanRead) {
    const fs::path file = folder_ / "open.bundle";
    fs::copy_file(bundles().file("bob.bundle"), file);
    ::chmod(file.c_str(), 0644);
    options_.security = file.string();
    const Error error = error_of_entering();
    EXPECT_EQ(error.kind, ErrorKind::kConfiguration);
    EXPECT_THAT(error.message, AllOf(HasSubstr("bus.security: "), HasSubstr("chmod 600")));
    ::chmod(file.c_str(), 0600);
    EXPECT_EQ(entered(), "bob");
}

TEST_F(EnterKeys, RefusesKeysThatHaveExpiredOrAreNotValidYet) {
    fs::create_directory(folder_ / "old");
    const Bundles old(folder_ / "old", Timestamp::now() + -400 * kOneDay);
    options_.security = old.file("bob.bundle");
    const Error error = error_of_entering();
    EXPECT_EQ(error.kind, ErrorKind::kInvalidData);
    EXPECT_THAT(error.message,
                AllOf(HasSubstr("bus.security: " + old.file("bob.bundle") + ": "),
                      HasSubstr("has expired"),
                      HasSubstr("renew bob")));
    fs::create_directory(folder_ / "new");
    const Bundles future(folder_ / "new", Timestamp::now() + 10 * kOneDay);
    options_.security = future.file("bob.bundle");
    EXPECT_THAT(error_of_entering().message, HasSubstr("is the clock right?"));
}

TEST_F(EnterKeys, RefusesADamagedFile) {
    const fs::path file = folder_ / "damaged.bundle";
    ASSERT_TRUE(keys::write_private_file(file, "format = 1\n", keys::Existing::kKeep));
    options_.security = file.string();
    EXPECT_EQ(error_of_entering().kind, ErrorKind::kInvalidData);
}

TEST_F(EnterKeys, RefusesKeysOfAnotherKind) {
    options_.security = bundles().file("bob.bundle");
    std::string name;
    const auto refused = enter_keys(options_, Kind::kSite, name);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("has the keys of viewer bob of world playroom"),
                      HasSubstr("needs those of a site: `atrium keys add site NAME`")));
    EXPECT_EQ(name, "");
    EXPECT_THAT(enter_keys(options_, Kind::kWorld, name).error().message,
                HasSubstr("needs those of a world: `atrium keys add world`"));
    EXPECT_TRUE(enter_keys(options_, Kind::kViewer, name));
}

TEST_F(EnterKeys, RefusesAnotherName) {
    options_.security = bundles().file("bob.bundle");
    std::string name = "eve";
    const auto refused = enter_keys(options_, Kind::kViewer, name);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("viewer bob"), HasSubstr("this program is named 'eve'")));
    EXPECT_EQ(name, "eve");
    for (std::string other : {"bo", "bobby", "bob.left", "Bob"})
        EXPECT_FALSE(enter_keys(options_, Kind::kViewer, other)) << other;
}

TEST_F(EnterKeys, NamesTheProgramAsItsKeys) {
    options_.security = bundles().file("bob.bundle");
    std::string name;
    ASSERT_TRUE(enter_keys(options_, Kind::kViewer, name));
    EXPECT_EQ(name, "bob");
    EXPECT_TRUE(enter_keys(options_, Kind::kViewer, name));
    EXPECT_EQ(name, "bob");
}

TEST_F(EnterKeys, JoinsOnlyWithAFileThatHasATunnel) {
    options_.join = bundles().file("alice.bundle");
    const Error error = error_of_entering();
    EXPECT_EQ(error.kind, ErrorKind::kConfiguration);
    EXPECT_THAT(error.message,
                AllOf(HasSubstr("bus.join: "),
                      HasSubstr("alice.bundle has no tunnel"),
                      HasSubstr("atrium keys invite")));
}

TEST_F(EnterKeys, JoinsOnlyThroughATunnelThatIsUp) {
    options_.join = bundles().file("bob.invitation");
    const Error error = error_of_entering();
    EXPECT_EQ(error.kind, ErrorKind::kUnavailable);
    EXPECT_THAT(error.message,
                AllOf(HasSubstr("bus.join: the tunnel wg-playroom is not up"),
                      HasSubstr("`sudo atrium tunnel up '" + options_.join + "'`")));
    EXPECT_EQ(options_.network, BusOptions().network);
    EXPECT_EQ(options_.interface, "");
    EXPECT_EQ(options_.peers, "");
    EXPECT_EQ(options_.world, BusOptions().world);
}

TEST_F(EnterKeys, NamesJoinIfItsKeysAreOfAnotherWorld) {
    options_.join = bundles().file("bob.invitation");
    options_.world = "elsewhere";
    const Error error = error_of_entering();
    EXPECT_EQ(error.kind, ErrorKind::kConfiguration);
    EXPECT_THAT(error.message, AllOf(HasSubstr("bus.join: "), HasSubstr("'elsewhere'")));
}

// An invitation is a bundle as well.
TEST_F(EnterKeys, NeedsNoTunnelWithoutJoin) {
    options_.security = bundles().file("bob.invitation");
    EXPECT_EQ(entered(), "bob");
    EXPECT_EQ(options_.network, BusOptions().network);
    EXPECT_EQ(options_.peers, "");
}

TEST_F(EnterKeys, TakesAnInvitationBeforeTheEnvironmentAndNotBesideABundle) {
    security_.set(bundles().file("mona.bundle"));
    options_.join = (folder_ / "none.invitation").string();
    Error error = error_of_entering();
    EXPECT_EQ(error.kind, ErrorKind::kNotFound);
    EXPECT_THAT(error.message, AllOf(HasSubstr("bus.join: "), HasSubstr("none.invitation")));
    for (const std::string& security : {std::string("none"), bundles().file("alice.bundle")}) {
        options_.security = security;
        error = error_of_entering();
        EXPECT_EQ(error.kind, ErrorKind::kConfiguration);
        EXPECT_THAT(error.message, HasSubstr("leave --security out"));
    }
}

}  // namespace
}  // namespace atrium::bus
