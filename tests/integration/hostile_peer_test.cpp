#include "core/bus/bus.hpp"
#include "tests/integration/garbage.hpp"
#include "viewer/viewer.hpp"
#include "world_server/world_server.hpp"

#include <dds/dds.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>
#include <thread>
#include <vector>

// A peer in the world writes random memory on every topic and bypasses Atrium's own checks.
namespace atrium {
namespace {

constexpr std::uint32_t kDomain = 178;  // used by this test only
constexpr const char* kWorld = "hostile-peer-test";

bus::BusOptions bus_options() {
    bus::BusOptions options;
    options.world = kWorld;
    options.domain = kDomain;
    return options;
}

/// Writes without any of Atrium's checks.
template <typename Message>
class RawWriter {
public:
    RawWriter() {
        participant_ = dds_create_participant(kDomain, nullptr, nullptr);
        const dds_entity_t topic = dds_create_topic(participant_,
                                                    &bus::Topic<Message>::kDescriptor,
                                                    bus::Topic<Message>::kName,
                                                    nullptr,
                                                    nullptr);
        dds_qos_t* qos = dds_create_qos();
        dds_qset_partition1(qos, kWorld);
        dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
        dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
        dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_MSECS(1000));
        dds_qset_deadline(qos, DDS_MSECS(500));
        writer_ = dds_create_writer(participant_, topic, qos, nullptr);
        dds_delete_qos(qos);
    }
    ~RawWriter() { dds_delete(participant_); }
    RawWriter(const RawWriter&) = delete;
    RawWriter& operator=(const RawWriter&) = delete;

    bool is_open() const { return writer_ > 0; }
    void write_any(Garbage& garbage) {
        const auto wire = garbage.any<typename bus::Topic<Message>::Wire>();
        dds_write(writer_, &wire);  // may time out or be refused, which the bus is free to do
        garbage.forget();
    }

private:
    dds_entity_t participant_ = 0;
    dds_entity_t writer_ = 0;
};

TEST(HostilePeer, GarbageOnEveryTopicIsCountedAndHarmless) {
    world_server::WorldServerConfig world_config;
    world_config.bus = bus_options();
    auto world = world_server::WorldServer::create(world_config);
    ASSERT_TRUE(world) << world.error().message;
    viewer::ViewerConfig viewer_config;
    viewer_config.bus = bus_options();
    viewer_config.headless = true;
    viewer_config.view.debug = "on";  // the viewer then reads all topics
    viewer_config.view.width = 160;
    viewer_config.view.height = 120;
    auto viewer = viewer::Viewer::create(viewer_config);
    ASSERT_TRUE(viewer) << viewer.error().message;
    auto participant = bus::Participant::create(bus_options());
    ASSERT_TRUE(participant);
    auto status_reader = bus::Reader<bus::SiteStatus>::create(*participant);
    ASSERT_TRUE(status_reader);

    std::jthread world_thread([&](std::stop_token stop) { EXPECT_TRUE((*world)->run(stop)); });
    std::jthread viewer_thread([&](std::stop_token stop) { EXPECT_TRUE((*viewer)->run(stop)); });
    const auto num_status = status_reader->take([](bus::SiteStatus&&) {}).num_taken;
    EXPECT_EQ(num_status, 0u);

    RawWriter<bus::SiteDescription> descriptions;
    RawWriter<bus::SiteMesh> meshes;
    RawWriter<bus::CameraTexture> textures;
    RawWriter<bus::SitePlacement> placements;
    RawWriter<bus::SceneObject> objects;
    RawWriter<bus::SoftBody> soft_bodies;
    RawWriter<bus::SoftBodyState> soft_states;
    RawWriter<bus::Scenery> sceneries;
    RawWriter<bus::PersonProxy> person_proxies;
    RawWriter<bus::ObjectProxy> object_proxies;
    RawWriter<bus::SceneState> states;
    RawWriter<bus::SceneCommand> commands;
    RawWriter<bus::SceneEdit> edits;
    RawWriter<bus::EditResult> edit_results;
    RawWriter<bus::SavedWorlds> saved_worlds;
    RawWriter<bus::SiteStatus> site_statuses;
    RawWriter<bus::WorldStatus> world_statuses;
    RawWriter<bus::ViewerStatus> viewer_statuses;
    RawWriter<bus::Presence> presences;
    ASSERT_TRUE(descriptions.is_open() && meshes.is_open() && textures.is_open() &&
                placements.is_open() && objects.is_open() && states.is_open() &&
                commands.is_open() && site_statuses.is_open());

    Garbage garbage(4711);
    std::size_t num_status_rejected = 0;
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    const auto harassed_enough = [&] {
        return (*world)->status().num_rejected >= 50 && (*viewer)->status().num_rejected >= 50 &&
               num_status_rejected > 0;
    };
    for (int round = 0;
         (round < 400 || !harassed_enough()) && std::chrono::steady_clock::now() < give_up;
         ++round) {
        descriptions.write_any(garbage);
        meshes.write_any(garbage);
        textures.write_any(garbage);
        placements.write_any(garbage);
        objects.write_any(garbage);
        soft_bodies.write_any(garbage);
        soft_states.write_any(garbage);
        sceneries.write_any(garbage);
        person_proxies.write_any(garbage);
        object_proxies.write_any(garbage);
        states.write_any(garbage);
        commands.write_any(garbage);
        edits.write_any(garbage);
        edit_results.write_any(garbage);
        saved_worlds.write_any(garbage);
        site_statuses.write_any(garbage);
        world_statuses.write_any(garbage);
        viewer_statuses.write_any(garbage);
        presences.write_any(garbage);
        num_status_rejected += status_reader->take([](bus::SiteStatus&&) {}).num_rejected;
    }
    EXPECT_TRUE(harassed_enough())
        << "world " << (*world)->status().num_rejected << ", viewer "
        << (*viewer)->status().num_rejected << ", status " << num_status_rejected;

    // both programs continue
    const auto steps_before = (*world)->status().num_steps;
    const auto frames_before = (*viewer)->status().num_frames;
    const auto goes_on = [&] {
        return (*world)->status().num_steps > steps_before + 10 &&
               (*viewer)->status().num_frames > frames_before + 3;
    };
    while (!goes_on() && std::chrono::steady_clock::now() < give_up) std::this_thread::yield();
    EXPECT_TRUE(goes_on());
}

}  // namespace
}  // namespace atrium
