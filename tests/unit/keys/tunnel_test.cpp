#include "core/keys/tunnel.hpp"

#include "core/keys/bundle.hpp"
#include "tests/support/random.hpp"
#include "tests/unit/keys/a_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <array>
#include <cstdio>
#include <memory>
#include <set>

namespace atrium::keys {
namespace {

using namespace keys::testing;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

using RawKey = std::array<unsigned char, 32>;

std::string base64_of(const RawKey& key) {
    std::array<unsigned char, 45> text{};
    EVP_EncodeBlock(text.data(), key.data(), static_cast<int>(key.size()));
    return reinterpret_cast<const char*>(text.data());
}

// As WireGuard computes it.
std::string public_key_of(const std::string& private_key) {
    std::array<unsigned char, 33> secret{};
    EVP_DecodeBlock(secret.data(), reinterpret_cast<const unsigned char*>(private_key.data()), 44);
    const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(
        EVP_PKEY_new_raw_private_key(EVP_PKEY_X25519, nullptr, secret.data(), 32), EVP_PKEY_free);
    RawKey open{};
    std::size_t size = open.size();
    if (key == nullptr || EVP_PKEY_get_raw_public_key(key.get(), open.data(), &size) != 1)
        return "no key";
    return base64_of(open);
}

TEST(TunnelKeys, ComputeThePublicKeyOfAKnownPrivateOne) {
    // RFC 7748, section 6.1: the key pair of Alice
    EXPECT_EQ(public_key_of("dwdtCnMYpX08FsFyUbJmRd9ML4frwJkqsXf7pR25LCo="),
              "hSDwCYkwp1R0i33ctD73Wg2/Og0mOBr066SpjqqbTmo=");
}

TEST(TunnelKeys, BelongTogetherAndDiffer) {
    std::set<std::string> all;
    for (int i = 0; i < 20; ++i) {
        const TunnelKeys keys = value(make_tunnel_keys());
        EXPECT_TRUE(is_tunnel_key(keys.private_key));
        EXPECT_TRUE(is_tunnel_key(keys.public_key));
        EXPECT_EQ(public_key_of(keys.private_key), keys.public_key);
        all.insert({keys.private_key, keys.public_key});
    }
    EXPECT_EQ(all.size(), 40u);
}

TEST(TunnelKey, IsTheTextOf32Bytes) {
    test::Random random(7);
    for (int i = 0; i < 200; ++i) {
        RawKey bytes{};
        for (unsigned char& byte : bytes)
            byte = static_cast<unsigned char>(test::between(random, 0, 255));
        EXPECT_TRUE(is_tunnel_key(base64_of(bytes))) << base64_of(bytes);
    }
    EXPECT_TRUE(is_tunnel_key(base64_of({})));
}

TEST(TunnelKey, IsNoOtherText) {
    const std::string key = base64_of({1, 2, 3});
    ASSERT_TRUE(is_tunnel_key(key));
    EXPECT_FALSE(is_tunnel_key(""));
    EXPECT_FALSE(is_tunnel_key(key.substr(1)));
    EXPECT_FALSE(is_tunnel_key(key + "="));
    EXPECT_FALSE(is_tunnel_key(key + "\n"));
    EXPECT_FALSE(is_tunnel_key(" " + key.substr(1)));
    EXPECT_FALSE(is_tunnel_key(key.substr(0, 43) + "A")) << "33 bytes";
    EXPECT_FALSE(is_tunnel_key(key.substr(0, 42) + "==")) << "31 bytes";
    // the two bits after the 32nd byte are zero in the only text of a key
    for (const char last : {'B', 'C', 'D'}) {
        std::string other = key;
        ASSERT_EQ(other[42], 'A');
        other[42] = last;
        EXPECT_FALSE(is_tunnel_key(other)) << last;
    }
    for (const char bad : {'*', '-', '_', '=', '\0', '"', '\n'}) {
        std::string other = key;
        other[20] = bad;
        EXPECT_FALSE(is_tunnel_key(other)) << static_cast<int>(bad);
    }
}

TEST(Subnet, IsDrawnFromTheUpperHalf) {
    std::set<std::string> drawn;
    for (int i = 0; i < 100; ++i) {
        const std::string subnet = value(draw_subnet());
        int second = 0;
        int third = 0;
        char more = 0;
        ASSERT_EQ(std::sscanf(subnet.c_str(), "10.%d.%d%c", &second, &third, &more), 2) << subnet;
        EXPECT_TRUE(second >= 128 && second <= 247 && third >= 0 && third <= 255) << subnet;
        drawn.insert(subnet);
    }
    EXPECT_GT(drawn.size(), 50u);
}

TEST(Hub, IsAHostWithAPort) {
    EXPECT_EQ(*parse_hub("studio.example.org"), "studio.example.org:51820");
    EXPECT_EQ(*parse_hub("192.0.2.7:443"), "192.0.2.7:443");
    EXPECT_EQ(*parse_hub("studio:1"), "studio:1");
    EXPECT_EQ(*parse_hub("studio:65535"), "studio:65535");
    const std::string long_host = std::string(100, 'a') + "." + std::string(152, 'b');
    EXPECT_EQ(*parse_hub(long_host), long_host + ":51820");
    EXPECT_EQ(port_of_hub("192.0.2.7:443"), 443);
    EXPECT_EQ(port_of_hub("studio:65535"), 65535);
    EXPECT_EQ(port_of_hub(*parse_hub("studio")), 51820);
}

TEST(Hub, IsNothingElse) {
    for (const char* text : {"",
                             ":",
                             ":51820",
                             ".studio",
                             "-studio",
                             "studio/1",
                             "http://studio",
                             "studio example",
                             "::1",
                             "[::1]:51820",
                             "studio\n",
                             "st\"udio"}) {
        const auto hub = parse_hub(text);
        ASSERT_FALSE(hub) << text;
        EXPECT_EQ(hub.error().kind, ErrorKind::kConfiguration);
        EXPECT_THAT(hub.error().message, HasSubstr("HOST or HOST:PORT"));
    }
    for (const char* text : {"studio:",
                             "studio:0",
                             "studio:65536",
                             "studio:-1",
                             "studio:+1",
                             "studio: 1",
                             "studio:01",
                             "studio:1x",
                             "studio:1:2",
                             "studio:99999999999999999999"}) {
        const auto hub = parse_hub(text);
        ASSERT_FALSE(hub) << text;
        EXPECT_THAT(hub.error().message, HasSubstr("1..65535"));
    }
    EXPECT_FALSE(parse_hub(std::string(254, 'a')));
}

TEST(TunnelCard, HasANameThatLinuxTakes) {
    EXPECT_EQ(tunnel_card("playroom"), "wg-playroom");
    EXPECT_EQ(tunnel_card("w"), "wg-w");
    EXPECT_EQ(tunnel_card(std::string(63, 'w')).size(), 15u);
    EXPECT_NE(tunnel_card("playroom-north-1"), tunnel_card("playroom-north-2"));
}

std::string key_of(unsigned char number) { return base64_of({number}); }

Tunnel a_tunnel(const std::string& name) {
    return {"studio.example.org:4711",
            name,
            key_of(200),
            {{"hall", "10.200.7.1", key_of(1)},
             {"bob", "10.200.7.2", key_of(2)},
             {"alice", "10.200.7.254", key_of(3)}}};
}

Bundle with_tunnel(Tunnel tunnel) {
    Bundle bundle = a_world().bundle(tunnel.name);
    bundle.tunnel = std::move(tunnel);
    return bundle;
}

TEST(Tunnel, KnowsItsOwnPlace) {
    EXPECT_TRUE(a_tunnel("hall").is_hub());
    EXPECT_FALSE(a_tunnel("bob").is_hub());
    EXPECT_EQ(a_tunnel("bob").own().address, "10.200.7.2");
    EXPECT_EQ(a_tunnel("hall").own().public_key, key_of(1));
}

TEST(Tunnel, ComesBackFromABundle) {
    for (const char* name : {"hall", "bob", "alice"}) {
        const Tunnel tunnel = a_tunnel(name);
        const Bundle back = value(parse_bundle(bundle_text(with_tunnel(tunnel)), "a.bundle"));
        ASSERT_TRUE(back.tunnel) << name;
        EXPECT_EQ(back.tunnel->hub, tunnel.hub);
        EXPECT_EQ(back.tunnel->name, name);
        EXPECT_EQ(back.tunnel->private_key, tunnel.private_key);
        ASSERT_EQ(back.tunnel->places.size(), tunnel.places.size());
        for (std::size_t i = 0; i < tunnel.places.size(); ++i) {
            EXPECT_EQ(back.tunnel->places[i].name, tunnel.places[i].name);
            EXPECT_EQ(back.tunnel->places[i].address, tunnel.places[i].address);
            EXPECT_EQ(back.tunnel->places[i].public_key, tunnel.places[i].public_key);
        }
        EXPECT_TRUE(check(back, kNow));
    }
    EXPECT_FALSE(value(parse_bundle(bundle_text(a_world().bundle("bob")), "a.bundle")).tunnel);
}

TEST(Tunnel, HasRoomForAllAddresses) {
    Tunnel tunnel = a_tunnel("hall");
    tunnel.places.resize(1);
    for (int i = 2; i <= 254; ++i)
        tunnel.places.push_back({"place" + std::to_string(i),
                                 "10.200.7." + std::to_string(i),
                                 key_of(static_cast<unsigned char>(i))});
    ASSERT_EQ(tunnel.places.size(), kMaxPlaces);
    const std::string text = bundle_text(with_tunnel(tunnel));
    EXPECT_LT(text.size(), kMaxBundleBytes);
    EXPECT_EQ(value(parse_bundle(text, "a.bundle")).tunnel->places.size(), kMaxPlaces);
}

class DamagedTunnel : public ::testing::Test {
protected:
    // Replaces the first `from` in the table [tunnel]; returns the refusal.
    std::string refusal_with(const std::string& from, const std::string& to) {
        std::string text = bundle_text(with_tunnel(a_tunnel("bob")));
        const std::size_t at = text.find(from, text.find("[tunnel]"));
        if (at == std::string::npos) return "no such text: " + from;
        const auto parsed = parse_bundle(text.replace(at, from.size(), to), "a.bundle");
        if (parsed) return "accepted";
        EXPECT_EQ(parsed.error().kind, ErrorKind::kInvalidData) << to;
        EXPECT_THAT(parsed.error().message,
                    AllOf(HasSubstr("a.bundle: "), Not(HasSubstr(key_of(200).substr(0, 12)))))
            << to;
        return parsed.error().message;
    }
};

TEST_F(DamagedTunnel, IsRefusedWithAnotherHub) {
    for (const char* hub : {"", "studio", "studio:0", "studio:x", "a b:1", "studio:1\\\"", "::1"})
        EXPECT_THAT(refusal_with("studio.example.org:4711", hub), HasSubstr("of the hub")) << hub;
}

TEST_F(DamagedTunnel, IsRefusedWithAnotherName) {
    const std::string own = "name = \"bob\"\nprivate";
    for (const char* name : {"eve", "", "../bob"})
        EXPECT_THAT(refusal_with(own, std::string("name = \"") + name + "\"\nprivate"),
                    HasSubstr("no place with its own name"))
            << name;
    EXPECT_THAT(refusal_with(own, "name = \"alice\"\nprivate"),
                HasSubstr("the tunnel of another member"));
}

TEST_F(DamagedTunnel, IsRefusedWithADamagedPrivateKey) {
    const std::string key = key_of(200);
    for (const std::string& other : {std::string(), key.substr(1), key + "=", "*" + key.substr(1)})
        EXPECT_THAT(refusal_with(key, other), HasSubstr("a damaged private key")) << other;
    // errors of TOML quote lines
    EXPECT_THAT(refusal_with(key + "\"", key), HasSubstr("is no bundle"));
    EXPECT_THAT(refusal_with("private_key = \"" + key, "private_key = [\"" + key),
                HasSubstr("is no bundle"));
}

TEST_F(DamagedTunnel, IsRefusedWithADamagedPlace) {
    for (const char* name : {"", ".alice", "a/b", "a b"})
        EXPECT_THAT(refusal_with("name = \"alice\"", std::string("name = \"") + name + "\""),
                    HasSubstr("a place without a name"))
            << name;
    EXPECT_THAT(refusal_with(key_of(3), key_of(3).substr(1)), HasSubstr("a damaged public key"));
    EXPECT_THAT(refusal_with("name = \"alice\"", "name = \"hall\""),
                HasSubstr("two places with the same name or address"));
    EXPECT_THAT(refusal_with("10.200.7.254", "10.200.7.1"),
                HasSubstr("two places with the same name or address"));
    EXPECT_THAT(refusal_with("address = \"10.200.7.254\"", "port = 7"), HasSubstr("a.bundle"));
    EXPECT_THAT(refusal_with("address = \"10.200.7.254\"", "address = 7"), HasSubstr("a.bundle"));
}

TEST_F(DamagedTunnel, IsRefusedWithAnAddressThatIsNoneOfItsSubnet) {
    for (const char* address : {"",
                                "10.200.7.0",
                                "10.200.7.255",
                                "10.200.7.256",
                                "10.200.7.03",
                                "10.200.7.3.",
                                "10.200.7.3.4",
                                "10.200.7.",
                                "10.200.7",
                                "10.200..3",
                                "10.256.7.3",
                                "10.200.7.-3",
                                "10.200.7.3/8",
                                " 10.200.7.3",
                                "10.200.8.3",
                                "10.201.7.3",
                                "11.200.7.3",
                                "0.0.0.0",
                                "::1"})
        EXPECT_THAT(refusal_with("10.200.7.254", address), HasSubstr("a wrong address")) << address;
    EXPECT_EQ(refusal_with("10.200.7.254", "10.200.7.3"), "accepted");
}

TEST_F(DamagedTunnel, IsRefusedWithMoreOrOtherTables) {
    EXPECT_THAT(refusal_with("[tunnel]\n", "[tunnel]\nport = 7\n"), HasSubstr("was changed"));
    EXPECT_THAT(refusal_with("[[tunnel.place]]", "[[tunnel.place]]\nport = 7"),
                HasSubstr("was changed"));
    std::string text = bundle_text(a_world().bundle("bob"));
    const std::size_t begin = text.find("format");
    EXPECT_FALSE(parse_bundle(text.insert(begin, "tunnel = 7\n"), "a.bundle"));
}

TEST(WireGuardText, OfTheHubHasAllSpokes) {
    EXPECT_EQ(wireguard_text(a_tunnel("hall")),
              "[Interface]\nPrivateKey = " + key_of(200) + "\nListenPort = 4711\n" +
                  "\n[Peer]\nPublicKey = " + key_of(2) + "\nAllowedIPs = 10.200.7.2/32\n" +
                  "\n[Peer]\nPublicKey = " + key_of(3) + "\nAllowedIPs = 10.200.7.254/32\n");
}

TEST(WireGuardText, OfASpokeHasTheHub) {
    EXPECT_EQ(wireguard_text(a_tunnel("bob")),
              "[Interface]\nPrivateKey = " + key_of(200) + "\n" +
                  "\n[Peer]\nPublicKey = " + key_of(1) +
                  "\nEndpoint = studio.example.org:4711\nAllowedIPs = 10.200.7.0/24\n"
                  "PersistentKeepalive = 25\n");
}

}  // namespace
}  // namespace atrium::keys
