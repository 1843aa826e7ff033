#include "tests/integration/security/closed_world_fixture.hpp"
#include "tests/integration/security/sniffer.hpp"
#include "tests/support/network/own_network.hpp"
#include "tests/support/skips.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <unordered_set>

// Those who have no keys, but reach the network: who listens, replays and floods.
namespace atrium::test {
namespace {

using Datagrams = std::vector<std::vector<std::uint8_t>>;
constexpr std::size_t kProbeBytes = 16;

std::string_view text_of(const std::vector<std::uint8_t>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Pieces of the payloads that occur nowhere else by chance.
std::unordered_set<std::string> probes_of(const Datagrams& payloads) {
    std::unordered_set<std::string> probes;
    for (const auto& payload : payloads) {
        for (std::size_t at = 0; at + kProbeBytes <= payload.size(); at += 300) {
            const std::string probe(text_of(payload).substr(at, kProbeBytes));
            if (std::unordered_set<char>(probe.begin(), probe.end()).size() >= 10)
                probes.insert(probe);
        }
    }
    return probes;
}

std::size_t num_found(const std::unordered_set<std::string>& probes, const Datagrams& datagrams) {
    std::size_t found = 0;
    std::string window;
    for (const auto& datagram : datagrams) {
        const std::string_view text = text_of(datagram);
        for (std::size_t at = 0; at + kProbeBytes <= text.size(); ++at) {
            window.assign(text.substr(at, kProbeBytes));
            found += probes.count(window);
        }
    }
    return found;
}

void write_datagrams(const fs::path& file, const Datagrams& datagrams) {
    std::ofstream stream(file, std::ios::binary);
    for (const auto& datagram : datagrams) {
        const auto size = static_cast<std::uint32_t>(datagram.size());
        stream.write(reinterpret_cast<const char*>(&size), sizeof size);
        stream.write(text_of(datagram).data(), size);
    }
}

// The lease in an announcement (PID_PARTICIPANT_LEASE_DURATION), which is kept for so long.
void make_endless(std::vector<std::uint8_t>& announcement) {
    constexpr std::array<std::uint8_t, 4> kLease{0x02, 0x00, 0x08, 0x00};
    constexpr std::array<std::uint8_t, 8> kForEver{0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff, 0xff};
    const auto at =
        std::search(announcement.begin(), announcement.end(), kLease.begin(), kLease.end());
    ASSERT_GT(announcement.end() - at, 12);
    std::ranges::copy(kForEver, at + 4);
}

std::size_t resident_kB(const HostedProcess& process) {
    std::ifstream status(fmt::format("/proc/{}/status", process.id()));
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmRSS:")) return std::stoul(line.substr(6));
    return 0;
}

class Outsiders : public ClosedWorldTest {
protected:
    void SetUp() override {
        auto sniffer = Sniffer::start();
        if (!sniffer) GTEST_SKIP() << skip::kNoNetwork << sniffer.error().message;
        sniffer_ = std::move(*sniffer);
    }
    // Floods while alice publishes thirty meshes: none is lost, and nobody grows.
    void flood(std::vector<std::string> arguments) {
        const std::size_t before =
            resident_kB(world().alice()) + resident_kB(world().world_server());
        attacker_ = world().start("security_flood", arguments);
        ASSERT_TRUE(attacker_->wait_for_output("floods", 10s));
        let_pass();
        end();
        const std::size_t after =
            resident_kB(world().alice()) + resident_kB(world().world_server());
        EXPECT_LT(after, before + 100'000) << before << " kB before";
        let_pass();
    }

    std::unique_ptr<Sniffer> sniffer_;
};

TEST_F(Outsiders, WhoListensReadsNothing) {
    // the same in an open world is read: what two programs without keys say
    attack({}, {"--read", "open"});
    auto speaker = std::move(attacker_);
    attack({}, {"--topic", "SiteMesh", "--site", "alice", "--partition", "open", "--read", "open"});
    world().take_payloads();
    let_pass();
    const Datagrams payloads = world().take_payloads();
    const Datagrams heard = sniffer_->take();
    end();
    speaker->signal(SIGTERM);
    EXPECT_TRUE(speaker->wait(20s));
    const std::string open_mesh(200, '\x07');
    EXPECT_TRUE(std::ranges::any_of(heard, [&](const auto& datagram) {
        return text_of(datagram).find(open_mesh) != std::string_view::npos;
    })) << "the sniffer works";
    const auto probes = probes_of(payloads);
    EXPECT_GT(probes.size(), 40u);
    EXPECT_EQ(num_found(probes, payloads) > 0, true) << "the search works";
    EXPECT_EQ(num_found(probes, heard), 0u);
    for (const char* word : {"SiteMesh", "playroom/site/alice"}) {
        EXPECT_EQ(std::ranges::count_if(
                      heard,
                      [&](const auto& datagram) {
                          return text_of(datagram).find(word) != std::string_view::npos &&
                                 text_of(datagram).find("open") == std::string_view::npos;
                      }),
                  0)
            << word;
    }
}

TEST_F(Outsiders, ReplayedDatagramsChangeNothing) {
    sniffer_->take();
    let_pass();
    const fs::path file = world().folder() / "replayed";
    write_datagrams(file, sniffer_->take());
    flood({"--datagrams", file.string(), "--rate", "3000"});
}

TEST_F(Outsiders, GarbageChangesNothing) { flood({"--rate", "20000"}); }

TEST_F(Outsiders, HandshakesOfStrangersChangeNothing) {
    // announcements of a program with keys of another store
    auto other = value(keys::KeyStore::create(
        world().folder() / "strangers.keys", "playroom", 365, Timestamp::now()));
    value(other.add({"playroom", Kind::kViewer, "stranger", {}}, 30, Timestamp::now()));
    sniffer_->take();
    attack(world().write("stranger.bundle", keys::bundle_text(value(other.bundle("stranger")))),
           {"--read", "playroom/site/alice"});
    let_pass();
    end_deaf();
    Datagrams announcements;
    for (auto& datagram : sniffer_->take()) {
        const std::string_view text = text_of(datagram);
        const bool is_announcement = text.find("DDS:Auth:PKI-DH") != std::string_view::npos &&
                                     text.find("security_attacker") != std::string_view::npos;
        if (is_announcement && announcements.size() < 8)
            announcements.push_back(std::move(datagram));
    }
    ASSERT_FALSE(announcements.empty());
    const fs::path file = world().folder() / "announcements";
    for (auto& announcement : announcements) make_endless(announcement);
    write_datagrams(file, announcements);
    const std::size_t num_honest = world().num_participants();
    flood({"--datagrams", file.string(), "--new-prefix", "--rate", "100"});
    EXPECT_GT(world().num_participants(), num_honest + 20) << "the flood works";
    EXPECT_TRUE(world().wait_until([&] { return world().num_participants() <= num_honest; }, 60s))
        << world().num_participants() << " instead of " << num_honest;
}

}  // namespace
}  // namespace atrium::test

int main(int argc, char** argv) {
    atrium::test_support::enter_own_network(1);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
