#include "core/bus/bus.hpp"
#include "core/bus/entity.hpp"
#include "core/bus/participant.hpp"
#include "core/bus/topics.hpp"
#include "core/bus/wire.hpp"
#include "core/codec/mesh_codec.hpp"
#include "tests/support/shapes/decode_mesh.hpp"
#include "tests/unit/bus/bus_support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include <csignal>
#include <limits>
#include <memory>
#include <random>
#include <set>

namespace atrium::bus {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using testing::Listener;
using testing::own_world;
using testing::value;
using Clock = std::chrono::steady_clock;

// a lease of 1 s, and as much for a busy machine: the promise of qos/profiles.xml
constexpr auto kGoneWithin = 2s;

/// Another process that runs a site. The destructor kills it.
class Peer {
public:
    Peer(const BusOptions& options, const std::string& site) {
        std::string program = ATRIUM_BUS_PEER;
        std::string domain = std::to_string(options.domain);
        std::string world = options.world;
        std::string name = site;
        char* arguments[] = {program.data(), domain.data(), world.data(), name.data(), nullptr};
        if (posix_spawn(&pid_, program.c_str(), nullptr, nullptr, arguments, environ) != 0)
            throw std::runtime_error("cannot start " + program);
    }
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;
    ~Peer() { kill_now(); }

    void signal(int number) const { ::kill(pid_, number); }
    void kill_now() {
        if (pid_ <= 0) return;
        signal(SIGKILL);
        waitpid(pid_, nullptr, 0);
        pid_ = 0;
    }

private:
    pid_t pid_ = 0;
};

TEST(BusFaults, KilledSiteIsGoneWithinTwoSeconds) {
    const BusOptions options = own_world("killed", 110);
    const auto participant = value(Participant::create(options));
    Listener<SiteDescription> descriptions(participant);
    Listener<SiteMesh> meshes(participant);
    Peer peer(options, "doomed");
    ASSERT_TRUE(descriptions.await([&] { return !descriptions.samples.empty(); }));
    ASSERT_TRUE(meshes.await([&] { return meshes.samples.size() >= 5; }));
    EXPECT_TRUE(descriptions.gone.empty());

    peer.kill_now();
    const auto killed_at = Clock::now();
    ASSERT_TRUE(descriptions.await([&] { return !descriptions.gone.empty(); }));
    ASSERT_TRUE(meshes.await([&] { return !meshes.gone.empty(); }));
    EXPECT_LT(Clock::now() - killed_at, kGoneWithin);
    EXPECT_EQ(descriptions.gone.front().site, "doomed");
    EXPECT_EQ(meshes.gone.front().site, "doomed");
    EXPECT_EQ(descriptions.endings.front(), Ending::kLost);
    EXPECT_EQ(meshes.endings.front(), Ending::kLost);

    // A site that returns appears again without help.
    descriptions.forget();
    const Peer again(options, "doomed");
    EXPECT_TRUE(descriptions.await([&] { return !descriptions.samples.empty(); }));
}

TEST(BusFaults, FrozenSiteIsGoneAndReturnsByItself) {
    const BusOptions options = own_world("frozen", 111);
    const auto participant = value(Participant::create(options));
    Listener<SiteDescription> descriptions(participant);
    Listener<SiteMesh> meshes(participant);
    const Peer peer(options, "sleepy");
    ASSERT_TRUE(descriptions.await([&] { return !descriptions.samples.empty(); }));

    peer.signal(SIGSTOP);
    const auto frozen_at = Clock::now();
    ASSERT_TRUE(descriptions.await([&] { return !descriptions.gone.empty(); }));
    EXPECT_LT(Clock::now() - frozen_at, kGoneWithin);

    // The site wrote its description only once, at its start. The reader must receive it again.
    descriptions.forget();
    meshes.forget();
    peer.signal(SIGCONT);
    EXPECT_TRUE(descriptions.await([&] { return !descriptions.samples.empty(); }));
    EXPECT_TRUE(meshes.await([&] { return !meshes.samples.empty(); }));
}

// More than the 10 participants that Cyclone allows by default, and more than the former limit of
// 31.
TEST(BusFaults, FortyProgramsOnOneHostFindEachOther) {
    const BusOptions options = own_world("forty", 112);
    const auto participant = value(Participant::create(options));
    Listener<SiteDescription> descriptions(participant);
    std::vector<std::unique_ptr<Peer>> peers;
    for (int i = 0; i < 40; ++i)
        peers.push_back(std::make_unique<Peer>(options, "site-" + std::to_string(i)));
    std::set<std::string> seen;
    EXPECT_TRUE(descriptions.await(
        [&] {
            for (const auto& description : descriptions.samples) seen.insert(description.site);
            return seen.size() == peers.size();
        },
        60s))
        << seen.size();
}

/// Writes wire structs unchecked, which Writer never does.
template <typename Message>
class RawWriter {
public:
    explicit RawWriter(const Participant& participant)
        : topic_(value(own(dds_create_topic(participant.impl()->participant.get(),
                                            &Topic<Message>::kDescriptor,
                                            Topic<Message>::kName,
                                            nullptr,
                                            nullptr),
                           "topic"))),
          writer_(value(own(
              dds_create_writer(
                  participant.impl()->publisher.get(),
                  topic_.get(),
                  make_writer_qos(
                      participant.impl()->profiles.find(Topic<Message>::kProfile)->second.writer)
                      .get(),
                  nullptr),
              "writer"))) {}

    bool write(const typename Topic<Message>::Wire& wire) {
        return dds_write(writer_.get(), &wire) >= 0;
    }
    bool dispose(const typename Topic<Message>::Wire& wire) {
        return dds_dispose(writer_.get(), &wire) >= 0;
    }

private:
    Entity topic_;
    Entity writer_;
};

TEST(BusFaults, BadSampleIsCountedAndNamedAndGoodOnesPass) {
    const auto participant = value(Participant::create(own_world("bad")));
    Listener<SitePlacement> listener(participant);
    RawWriter<SitePlacement> raw(participant);
    WireScratch scratch;
    for (const char* site : {"a", "b", "c"}) {
        atrium_SitePlacement wire{};
        to_wire(SitePlacement{site, {}}, scratch, wire);
        if (*site == 'b')
            wire.world_from_site.translation[1] = std::numeric_limits<double>::infinity();
        ASSERT_TRUE(raw.write(wire));
    }
    ASSERT_TRUE(
        listener.await([&] { return listener.samples.size() + listener.num_rejected == 3; }));
    EXPECT_EQ(listener.samples.size(), 2U);
    EXPECT_EQ(listener.num_rejected, 1U);
    EXPECT_THAT(listener.first_rejection, HasSubstr("SitePlacement.world_from_site"));
}

TEST(BusFaults, InvalidKeyIsRejectedEvenIfDisposed) {
    const auto participant = value(Participant::create(own_world("key")));
    Listener<SiteMesh> listener(participant);
    RawWriter<SiteMesh> raw(participant);
    atrium_SiteMesh wire{};
    std::strcpy(wire.site, "../../etc/passwd");
    ASSERT_TRUE(raw.write(wire));
    ASSERT_TRUE(listener.await([&] { return listener.num_rejected == 1; }));
    ASSERT_TRUE(raw.dispose(wire));
    ASSERT_TRUE(listener.await([&] { return listener.num_rejected == 2; }));
    EXPECT_TRUE(listener.samples.empty());
    EXPECT_TRUE(listener.gone.empty());
}

TEST(BusFaults, GarbageInCodedBytesIsRefusedByTheCodec) {
    const auto participant = value(Participant::create(own_world("garbage")));
    Listener<SiteMesh> listener(participant);
    RawWriter<SiteMesh> raw(participant);
    std::mt19937_64 random(5);
    WireScratch scratch;
    for (std::uint64_t frame = 1; frame <= 50; ++frame) {
        SiteMesh mesh{"a", frame, {1}, {}, std::vector<std::uint8_t>(1 + random() % 2000)};
        for (auto& byte : mesh.draco) byte = static_cast<std::uint8_t>(random());
        atrium_SiteMesh wire{};
        to_wire(mesh, scratch, wire);
        ASSERT_TRUE(raw.write(wire));
        ASSERT_TRUE(listener.await([&] { return listener.samples.size() == frame; }));
        EXPECT_FALSE(test::decode_mesh(listener.samples.back().draco).has_value());
    }
}

}  // namespace
}  // namespace atrium::bus
