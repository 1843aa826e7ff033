#include "core/keys/store.hpp"

#include "core/keys/private_file.hpp"
#include "tests/unit/keys/a_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

namespace atrium::keys {
namespace {

using namespace keys::testing;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

namespace fs = std::filesystem;

Member viewer(const std::string& name, Rights rights = {}) {
    return {"playroom", Kind::kViewer, name, rights};
}

std::vector<std::string> listed(const KeyStore& store, Timestamp now = kNow) {
    std::vector<std::string> lines;
    for (const Entry& entry : value(store.entries(now)))
        lines.push_back(entry.member.name + " " + std::string(state_text(entry.state)));
    return lines;
}

TEST(KeyStore, IsForItsOwnerOnly) {
    const AWorld world;
    int num_files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(world.folder())) {
        struct stat info {};
        ASSERT_EQ(::stat(entry.path().c_str(), &info), 0);
        EXPECT_EQ(info.st_mode & 0777U, entry.is_directory() ? 0700U : 0600U) << entry.path();
        ++num_files;
    }
    EXPECT_EQ(num_files, 8 + 5);
    struct stat info {};
    ASSERT_EQ(::stat(world.folder().c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777U, 0700U);
}

TEST(KeyStore, ListsItsMembersByName) {
    AWorld world;
    EXPECT_THAT(listed(world.store()),
                ElementsAre("alice valid", "anna valid", "bob valid", "hall valid", "mona valid"));
    EXPECT_THAT(listed(world.store(), kNow + 336 * kDay)[0], "alice expires soon");
    EXPECT_THAT(listed(world.store(), kNow + 334 * kDay)[0], "alice valid");
    EXPECT_THAT(listed(world.store(), kNow + 365 * kDay)[0], "alice expired");
    EXPECT_THAT(listed(world.store(), kNow + -2 * kDay)[0], "alice not valid yet");
}

TEST(KeyStore, IsNotMadeOverAnother) {
    const AWorld world;
    const auto again = KeyStore::create(world.folder(), "playroom", 10, kNow);
    ASSERT_FALSE(again);
    EXPECT_THAT(again.error().message, HasSubstr("exists already"));
    const test::TemporaryFolder folder;
    EXPECT_FALSE(KeyStore::create(folder / "a.keys", "..", 10, kNow));
    const auto lost = KeyStore::create(folder / "no" / "a.keys", "a", 10, kNow);
    ASSERT_FALSE(lost);
    EXPECT_THAT(lost.error().message, HasSubstr("create the folder"));
    // a slash at its end is no other folder
    EXPECT_TRUE(KeyStore::create((folder / "b.keys").string() + "/", "b", 10, kNow));
    EXPECT_TRUE(fs::exists(folder / "b.keys" / "store.toml"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / ""), {}), 1);
}

TEST(KeyStore, RefusesANameTwice) {
    AWorld world;
    for (const Kind kind : kKinds) {
        const auto again = world.store().add({"playroom", kind, "bob", {}}, 365, kNow);
        ASSERT_FALSE(again);
        EXPECT_THAT(again.error().message,
                    AllOf(HasSubstr("taken by a viewer"), HasSubstr("atrium keys renew bob")));
    }
    value(world.store().revoke("bob", Reason::kLeft, kNow));
    EXPECT_FALSE(world.store().add(viewer("bob"), 365, kNow));
}

TEST(KeyStore, RefusesNamesOfHostsOfASite) {
    AWorld world;
    EXPECT_FALSE(world.store().add(viewer("alice.left"), 365, kNow));
    EXPECT_TRUE(world.store().add(viewer("alicia.left"), 365, kNow));
    EXPECT_FALSE(world.store().add({"playroom", Kind::kSite, "alicia", {}}, 365, kNow));
    EXPECT_TRUE(world.store().add(viewer("bob.left"), 365, kNow));
}

TEST(KeyStore, MakesNoMemberThatOutlivesItsAuthorities) {
    AWorld world;
    const Entry entry = value(world.store().add(viewer("carl"), 36500, kNow));
    EXPECT_EQ(entry.validity.end, kNow + 3650 * kDay);
    EXPECT_EQ(value(check(world.bundle("carl"), kNow)).end, kNow + 3650 * kDay);
    const auto late = world.store().add(viewer("dora"), 1, kNow + 3651 * kDay);
    ASSERT_FALSE(late);
    EXPECT_THAT(late.error().message, HasSubstr("has expired"));
}

TEST(KeyStore, RevokesAndSaysWhy) {
    AWorld world;
    const Bundle stolen = world.bundle("bob");
    const Entry entry = value(world.store().revoke("bob", Reason::kLost, kNow));
    EXPECT_EQ(entry.state, State::kRevoked);
    ASSERT_TRUE(entry.revocation);
    EXPECT_EQ(entry.revocation->reason, Reason::kLost);
    EXPECT_EQ(entry.revocation->at, kNow);
    EXPECT_FALSE(check(world.bundle("bob"), kNow));
    EXPECT_TRUE(check(world.bundle("alice"), kNow));
    EXPECT_THAT(world.store().revoke("bob", Reason::kLost, kNow).error().message,
                HasSubstr("is revoked already"));
    EXPECT_THAT(world.store().revoke("eve", Reason::kLost, kNow).error().message,
                HasSubstr("has no member 'eve'"));
}

TEST(KeyStore, RenewsAndRevokesTheOldKey) {
    AWorld world;
    Bundle old = world.bundle("bob");
    value(world.store().renew("bob", std::nullopt, 100, kNow + kDay));
    const Bundle renewed = world.bundle("bob");
    EXPECT_EQ(renewed.member, old.member);
    EXPECT_NE(renewed.private_key, old.private_key);
    EXPECT_EQ(value(check(renewed, kNow + kDay)).end, kNow + 101 * kDay);
    old.crl = renewed.crl;
    EXPECT_FALSE(check(old, kNow + kDay));
    value(world.store().renew("bob", Rights{Right::kSave}, 100, kNow));
    EXPECT_EQ(world.bundle("bob").member.rights, Rights{Right::kSave});
    EXPECT_TRUE(check(world.bundle("bob"), kNow));
    EXPECT_FALSE(world.store().renew("alice", Rights{Right::kSave}, 100, kNow));
    EXPECT_TRUE(check(world.bundle("alice"), kNow));
}

TEST(KeyStore, RenewsAMemberThatWasRevoked) {
    AWorld world;
    value(world.store().revoke("bob", Reason::kLost, kNow));
    EXPECT_EQ(value(world.store().renew("bob", std::nullopt, 100, kNow)).state, State::kValid);
    EXPECT_TRUE(check(world.bundle("bob"), kNow));
}

TEST(KeyStore, KnowsAllAgainWhenItIsOpened) {
    const test::TemporaryFolder folder;
    {
        auto store = value(KeyStore::create(folder / "a.keys", "playroom", 3650, kNow));
        value(store.add(viewer("bob"), 365, kNow));
        value(store.add(viewer("eve"), 365, kNow));
        for (int i = 0; i < 5; ++i) value(store.renew("bob", std::nullopt, 365, kNow));
        value(store.revoke("eve", Reason::kLeft, kNow));
    }
    const auto store = value(KeyStore::open(folder / "a.keys", KeyStore::Access::kRead));
    EXPECT_EQ(store.world(), "playroom");
    EXPECT_THAT(listed(store), ElementsAre("bob valid", "eve revoked"));
    EXPECT_EQ(value(store.entries(kNow))[1].revocation->reason, Reason::kLeft);
    EXPECT_TRUE(check(value(store.bundle("bob")), kNow));
}

TEST(KeyStore, HasOneWriterOrSeveralReaders) {
    const test::TemporaryFolder folder;
    const auto open = [&](KeyStore::Access access) {
        return KeyStore::open(folder / "a.keys", access);
    };
    {
        const auto writer = value(KeyStore::create(folder / "a.keys", "playroom", 3650, kNow));
        EXPECT_EQ(open(KeyStore::Access::kRead).error().kind, ErrorKind::kUnavailable);
        EXPECT_THAT(open(KeyStore::Access::kWrite).error().message,
                    HasSubstr("another `atrium keys`"));
    }
    const auto reader = open(KeyStore::Access::kRead);
    EXPECT_TRUE(open(KeyStore::Access::kRead));
    EXPECT_FALSE(open(KeyStore::Access::kWrite));
}

TEST(KeyStore, IsRefusedIfOthersCanReadIt) {
    const test::TemporaryFolder folder;
    value(KeyStore::create(folder / "a.keys", "playroom", 3650, kNow));
    const auto open = [&] { return KeyStore::open(folder / "a.keys", KeyStore::Access::kRead); };
    ::chmod((folder / "a.keys").c_str(), 0755);
    EXPECT_THAT(open().error().message, HasSubstr("chmod 700"));
    EXPECT_THAT(problems_of_store(folder / "a.keys", kNow), ElementsAre(HasSubstr("chmod 700")));
    ::chmod((folder / "a.keys").c_str(), 0700);
    ::chmod((folder / "a.keys" / "identity.key").c_str(), 0644);
    EXPECT_THAT(open().error().message, HasSubstr("chmod 600"));
    EXPECT_THAT(problems_of_store(folder / "a.keys", kNow),
                ElementsAre(AllOf(HasSubstr("identity.key"), HasSubstr("chmod 600"))));
}

// Nobody is told to close a folder of the system, nor the files in it.
TEST(KeyStore, IsNoOtherFolderWhateverItsMode) {
    const test::TemporaryFolder folder;
    const fs::path other = folder / "etc";
    fs::create_directory(other);
    std::ofstream(other / "passwd") << "root\n";
    for (const mode_t mode : {0755U, 0700U}) {
        ::chmod(other.c_str(), mode);
        const auto opened = KeyStore::open(other, KeyStore::Access::kRead);
        ASSERT_FALSE(opened);
        EXPECT_EQ(opened.error().kind, ErrorKind::kNotFound);
        EXPECT_THAT(opened.error().message,
                    AllOf(HasSubstr("etc: is no key store"), Not(HasSubstr("chmod"))));
        EXPECT_THAT(problems_of_store(other, kNow), ElementsAre(opened.error().message));
    }
}

TEST(KeyStore, NamesWhatIsWrongInIt) {
    const test::TemporaryFolder folder;
    const fs::path path = folder / "a.keys";
    {
        auto store = value(KeyStore::create(path, "playroom", 3650, kNow));
        for (const char* name : {"bob", "eve", "tim"}) value(store.add(viewer(name), 365, kNow));
        value(store.revoke("tim", Reason::kLost, kNow));
    }
    EXPECT_THAT(problems_of_store(path, kNow), IsEmpty());
    EXPECT_THAT(problems_of_store(path, kNow + 400 * kDay), IsEmpty());  // all are expired
    EXPECT_THAT(problems_of_store(path, kNow + 3651 * kDay), SizeIs(1));
    EXPECT_THAT(problems_of_store(folder / "none", kNow),
                ElementsAre(HasSubstr("atrium keys init")));
    // one member in the place of another
    fs::copy_file(path / "members" / "bob.bundle",
                  path / "members" / "eve.bundle",
                  fs::copy_options::overwrite_existing);
    EXPECT_THAT(problems_of_store(path, kNow),
                ElementsAre(AllOf(HasSubstr("eve.bundle"), HasSubstr("viewer bob"))));
    // a key of another authority
    const test::TemporaryFolder other;
    value(KeyStore::create(other / "a.keys", "playroom", 3650, kNow));
    fs::copy_file(other / "a.keys" / "permissions.key",
                  path / "permissions.key",
                  fs::copy_options::overwrite_existing);
    EXPECT_THAT(problems_of_store(path, kNow)[0],
                AllOf(HasSubstr("permissions.key"), HasSubstr("does not belong")));
    fs::copy_file(
        other / "a.keys" / "crl.pem", path / "crl.pem", fs::copy_options::overwrite_existing);
    EXPECT_THAT(problems_of_store(path, kNow), ElementsAre(HasSubstr("crl.pem")));
    fs::remove(path / "store.toml");
    EXPECT_THAT(problems_of_store(path, kNow),
                ElementsAre(AllOf(HasSubstr("is no key store"), HasSubstr("no store.toml"))));
}

TEST(KeyStore, IgnoresWhatACrashLeft) {
    AWorld world;
    for (const char* name : {"crl.pem.123.new", "members/eve.bundle.123.new"})
        std::ofstream(world.folder() / name) << "half";
    EXPECT_THAT(listed(world.store()), SizeIs(5));
    EXPECT_TRUE(world.store().add(viewer("eve"), 365, kNow));
}

TEST(KeyStore, LeavesTheFolderOfNoMember) {
    AWorld world;
    for (const char* name : {"..", "../store", "a/b", ""}) {
        EXPECT_FALSE(world.store().bundle(name)) << name;
        EXPECT_FALSE(world.store().revoke(name, Reason::kLost, kNow)) << name;
        EXPECT_FALSE(world.store().renew(name, std::nullopt, 10, kNow)) << name;
    }
}

}  // namespace
}  // namespace atrium::keys
