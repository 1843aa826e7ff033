#include "core/keys/private_file.hpp"
#include "core/keys/store.hpp"
#include "tests/unit/keys/a_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace atrium::keys {
namespace {

using namespace keys::testing;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* kHub = "studio.example.org:51820";

std::string failure_of(const Expected<void>& done) {
    return done ? "no failure" : done.error().message;
}

std::string content_of(const std::filesystem::path& file) {
    std::stringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

// A store that can be opened again: it has hall, a world server, and bob and alice.
class StoreWithTunnel : public ::testing::Test {
protected:
    StoreWithTunnel() {
        store_.emplace(value(KeyStore::create(path_, "playroom", 3650, kNow)));
        for (const Member& member : {Member{"playroom", Kind::kWorld, "hall", {}},
                                     Member{"playroom", Kind::kViewer, "bob", {}},
                                     Member{"playroom", Kind::kSite, "alice", {}}})
            value(store_->add(member, 365, kNow));
    }

    void open_again() {
        store_.reset();
        store_.emplace(value(KeyStore::open(path_, KeyStore::Access::kWrite)));
    }
    Tunnel tunnel_of_member(const std::string& name) {
        return value(store_->bundle(name)).tunnel.value_or(Tunnel{});
    }
    std::string address_of(const std::string& name) {
        const Tunnel tunnel = tunnel_of_member(name);
        return tunnel.places.empty() ? "no place" : tunnel.own().address;
    }
    std::string last_number(const std::string& name) {
        const std::string address = address_of(name);
        return address.substr(std::min(address.rfind('.'), address.size()));
    }
    // The names of all places, as `name` knows them.
    std::vector<std::string> places_seen_by(const std::string& name) {
        std::vector<std::string> names;
        for (const Place& place : tunnel_of_member(name).places) names.push_back(place.name);
        return names;
    }
    Error error_on_opening() {
        store_.reset();
        const auto opened = KeyStore::open(path_, KeyStore::Access::kRead);
        return opened ? Error{ErrorKind::kInternal, "opened"} : opened.error();
    }

    test::TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "a.keys";
    std::optional<KeyStore> store_;
};

TEST_F(StoreWithTunnel, GivesNobodyAPlaceByItself) {
    for (const char* name : {"hall", "bob", "alice"})
        EXPECT_FALSE(value(store_->bundle(name)).tunnel) << name;
    EXPECT_FALSE(std::filesystem::exists(path_ / "tunnel.toml"));
}

TEST_F(StoreWithTunnel, MakesTheWorldServerTheHub) {
    ASSERT_TRUE(store_->add_place("bob", kHub));
    const Tunnel bob = tunnel_of_member("bob");
    EXPECT_EQ(bob.hub, kHub);
    EXPECT_FALSE(bob.is_hub());
    EXPECT_THAT(places_seen_by("bob"), ElementsAre("hall", "bob"));
    EXPECT_EQ(last_number("hall"), ".1");
    EXPECT_EQ(last_number("bob"), ".2");
    const Tunnel hub = tunnel_of_member("hall");
    EXPECT_TRUE(hub.is_hub());
    EXPECT_NE(hub.private_key, bob.private_key);
    EXPECT_NE(hub.places[0].public_key, hub.places[1].public_key);
    EXPECT_FALSE(value(store_->bundle("alice")).tunnel);
    // what members get can be read again
    for (const char* name : {"hall", "bob"}) {
        const Bundle bundle = value(store_->bundle(name));
        EXPECT_TRUE(value(parse_bundle(bundle_text(bundle), name)).tunnel) << name;
    }
}

TEST_F(StoreWithTunnel, GivesEachPlaceItsOwnAddress) {
    ASSERT_TRUE(store_->add_place("bob", kHub));
    const std::string key = tunnel_of_member("bob").private_key;
    const std::string address = address_of("bob");
    ASSERT_TRUE(store_->add_place("alice", ""));
    EXPECT_EQ(last_number("alice"), ".3");
    EXPECT_EQ(tunnel_of_member("alice").hub, kHub);
    EXPECT_EQ(tunnel_of_member("bob").private_key, key);
    EXPECT_EQ(address_of("bob"), address);
    EXPECT_THAT(places_seen_by("hall"), ElementsAre("hall", "bob", "alice"));
}

TEST_F(StoreWithTunnel, KeepsAPlaceThatAMemberHas) {
    ASSERT_TRUE(store_->add_place("bob", kHub));
    const std::string key = tunnel_of_member("bob").private_key;
    const std::string address = address_of("bob");
    ASSERT_TRUE(store_->add_place("bob", "10.1.1.1:7"));
    EXPECT_EQ(tunnel_of_member("bob").private_key, key);
    EXPECT_EQ(address_of("bob"), address);
    EXPECT_EQ(tunnel_of_member("bob").hub, "10.1.1.1:7");
    EXPECT_EQ(tunnel_of_member("hall").hub, "10.1.1.1:7");
    ASSERT_TRUE(store_->add_place("hall", ""));
    EXPECT_THAT(places_seen_by("hall"), ElementsAre("hall", "bob"));
}

TEST_F(StoreWithTunnel, CanBeginWithTheHub) {
    ASSERT_TRUE(store_->add_place("hall", kHub));
    EXPECT_THAT(places_seen_by("hall"), ElementsAre("hall"));
}

TEST_F(StoreWithTunnel, NamesWhatIsMissingForAPlace) {
    const auto without_hub = store_->add_place("bob", "");
    EXPECT_EQ(without_hub.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(failure_of(without_hub), HasSubstr("--hub HOST"));
    for (const char* name : {"eve", "", "..", "../store"})
        EXPECT_THAT(failure_of(store_->add_place(name, kHub)), HasSubstr("atrium keys list"));
    EXPECT_FALSE(std::filesystem::exists(path_ / "tunnel.toml"));

    const test::TemporaryFolder other;
    auto store = value(KeyStore::create(other / "b.keys", "playroom", 3650, kNow));
    value(store.add({"playroom", Kind::kViewer, "bob", {}}, 365, kNow));
    EXPECT_THAT(failure_of(store.add_place("bob", kHub)), HasSubstr("atrium keys add world"));
    EXPECT_FALSE(value(store.bundle("bob")).tunnel);
}

TEST_F(StoreWithTunnel, IsTheSameWhenItIsOpenedAgain) {
    ASSERT_TRUE(store_->add_place("bob", kHub));
    ASSERT_TRUE(store_->add_place("alice", ""));
    const std::string hub = bundle_text(value(store_->bundle("hall")));
    const std::string alice = bundle_text(value(store_->bundle("alice")));
    open_again();
    EXPECT_EQ(bundle_text(value(store_->bundle("hall"))), hub);
    EXPECT_EQ(bundle_text(value(store_->bundle("alice"))), alice);
    const std::string tunnel = content_of(path_ / "tunnel.toml");
    ASSERT_TRUE(store_->add_place("bob", ""));
    EXPECT_EQ(content_of(path_ / "tunnel.toml"), tunnel);
}

TEST_F(StoreWithTunnel, TakesThePlaceOfARevokedMember) {
    ASSERT_TRUE(store_->add_place("bob", kHub));
    ASSERT_TRUE(store_->add_place("alice", ""));
    const std::string old_key = tunnel_of_member("bob").private_key;
    value(store_->revoke("bob", Reason::kLost, kNow));
    EXPECT_FALSE(value(store_->bundle("bob")).tunnel);
    EXPECT_THAT(places_seen_by("hall"), ElementsAre("hall", "alice"));
    EXPECT_THAT(content_of(path_ / "tunnel.toml"), Not(HasSubstr(old_key)));
    EXPECT_EQ(last_number("alice"), ".3");
    open_again();
    EXPECT_THAT(places_seen_by("alice"), ElementsAre("hall", "alice"));
    // the address is free again, the key is not used again
    value(store_->renew("bob", std::nullopt, 365, kNow));
    EXPECT_FALSE(value(store_->bundle("bob")).tunnel);
    ASSERT_TRUE(store_->add_place("bob", ""));
    EXPECT_EQ(last_number("bob"), ".2");
    EXPECT_NE(tunnel_of_member("bob").private_key, old_key);
    EXPECT_THAT(places_seen_by("hall"), ElementsAre("hall", "alice", "bob"));
}

TEST_F(StoreWithTunnel, KeepsThePlaceOfARenewedMemberAndChangesItsKey) {
    ASSERT_TRUE(store_->add_place("bob", kHub));
    const std::string key = tunnel_of_member("bob").private_key;
    const std::string address = address_of("bob");
    value(store_->renew("bob", std::nullopt, 100, kNow));
    EXPECT_NE(tunnel_of_member("bob").private_key, key);
    EXPECT_EQ(address_of("bob"), address);
    const std::string hub = tunnel_of_member("hall").private_key;
    value(store_->renew("hall", std::nullopt, 100, kNow));
    EXPECT_EQ(tunnel_of_member("hall").private_key, hub) << "all others have its public key";
    open_again();
    EXPECT_THAT(places_seen_by("hall"), ElementsAre("hall", "bob"));
}

// Without it no place reaches another.
TEST_F(StoreWithTunnel, KeepsTheHubThoughItIsRevoked) {
    ASSERT_TRUE(store_->add_place("bob", kHub));
    value(store_->revoke("hall", Reason::kLeft, kNow));
    EXPECT_THAT(places_seen_by("bob"), ElementsAre("hall", "bob"));
    open_again();
    EXPECT_THAT(places_seen_by("bob"), ElementsAre("hall", "bob"));
}

TEST_F(StoreWithTunnel, HasAtMost254Places) {
    std::string keys = "private_keys = [";
    Tunnel full{kHub, "hall", value(make_tunnel_keys()).private_key, {}};
    for (int i = 1; i <= 254; ++i) {
        full.places.push_back({i == 1 ? std::string("hall") : "place" + std::to_string(i),
                               "10.200.7." + std::to_string(i),
                               value(make_tunnel_keys()).public_key});
        keys += "\"" + full.private_key + "\",";
    }
    const std::string text = keys + "]\n" + tunnel_text(full);
    ASSERT_TRUE(write_private_file(path_ / "tunnel.toml", text, Existing::kKeep));
    open_again();
    const auto one_more = store_->add_place("bob", "");
    ASSERT_FALSE(one_more);
    EXPECT_EQ(one_more.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(one_more.error().message, HasSubstr("all addresses of the tunnel are taken"));
    EXPECT_EQ(content_of(path_ / "tunnel.toml"), text);
}

TEST_F(StoreWithTunnel, NamesADamagedFile) {
    ASSERT_TRUE(store_->add_place("bob", kHub));
    const std::string key = tunnel_of_member("bob").private_key;
    const std::string text = content_of(path_ / "tunnel.toml");
    ASSERT_THAT(text, HasSubstr(key));
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string other = text;
        EXPECT_NE(other.find(from), std::string::npos) << from;
        return other.replace(other.find(from), from.size(), to);
    };
    for (const std::string& damaged : {std::string(),
                                       text.substr(0, text.size() / 2),
                                       replaced(key, ""),
                                       replaced(key, key.substr(1)),
                                       replaced("\"" + key + "\",", ""),
                                       replaced("\"" + key + "\"", key),
                                       replaced("]", "\"" + key + "\"]"),
                                       replaced("name = \"bob\"", "name = \"hall\""),
                                       replaced("private_keys", "other = 1\nprivate_keys")}) {
        ASSERT_TRUE(write_private_file(path_ / "tunnel.toml", damaged, Existing::kReplace));
        const Error error = error_on_opening();
        EXPECT_EQ(error.kind, ErrorKind::kInvalidData) << damaged;
        EXPECT_THAT(error.message,
                    AllOf(HasSubstr("tunnel.toml: "),
                          HasSubstr("restore it from a copy of the key store"),
                          Not(HasSubstr(key.substr(1, 12)))))
            << damaged;
        EXPECT_THAT(problems_of_store(path_, kNow), ElementsAre(HasSubstr("tunnel.toml")));
    }
    ASSERT_TRUE(write_private_file(path_ / "tunnel.toml", text, Existing::kReplace));
    EXPECT_THAT(problems_of_store(path_, kNow), IsEmpty());
}

TEST_F(StoreWithTunnel, IsForItsOwnerOnly) {
    ASSERT_TRUE(store_->add_place("bob", kHub));
    const std::filesystem::path file = path_ / "tunnel.toml";
    struct stat info {};
    ASSERT_EQ(::stat(file.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 07777U, 0600U);
    ::chmod(file.c_str(), 0640);
    EXPECT_THAT(error_on_opening().message,
                AllOf(HasSubstr("tunnel.toml"), HasSubstr("chmod 600")));
    EXPECT_THAT(problems_of_store(path_, kNow),
                ElementsAre(AllOf(HasSubstr("tunnel.toml"), HasSubstr("chmod 600"))));
}

}  // namespace
}  // namespace atrium::keys
