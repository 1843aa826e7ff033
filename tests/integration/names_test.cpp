#include "core/bus/bus.hpp"
#include "viewer/viewer.hpp"
#include "world_server/world_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

// Programs that claim a name that another program holds.
namespace atrium {
namespace {

using testing::AllOf;
using testing::HasSubstr;

bus::BusOptions bus_options() {
    bus::BusOptions options;
    options.world = "names-test";
    options.domain = 179;  // used by this test only
    return options;
}

TEST(Names, SecondServerOfAWorldIsRefusedAndTheFirstContinues) {
    world_server::WorldServerConfig config;
    config.bus = bus_options();
    auto first = world_server::WorldServer::create(config);
    ASSERT_TRUE(first) << first.error().message;
    {
        const std::jthread running([&](std::stop_token stop) {
            const auto done = (*first)->run(stop);
            EXPECT_TRUE(done) << done.error().message;
        });
        const auto second = world_server::WorldServer::create(config);
        ASSERT_FALSE(second);
        EXPECT_EQ(second.error().kind, ErrorKind::kConfiguration);
        EXPECT_THAT(second.error().message,
                    AllOf(HasSubstr("world server 'names-test'"), HasSubstr("pid ")));
        const auto steps = (*first)->status().num_steps;
        const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(30);
        while ((*first)->status().num_steps <= steps && std::chrono::steady_clock::now() < give_up)
            std::this_thread::yield();
        EXPECT_GT((*first)->status().num_steps, steps);
        config.bus.world = "another-world";
        EXPECT_TRUE(world_server::WorldServer::create(config)) << "worlds must be isolated";
    }
    first->reset();
    config.bus = bus_options();
    EXPECT_TRUE(world_server::WorldServer::create(config)) << "the name must be free again";
}

TEST(Names, SecondViewerOfAGivenNameIsRefusedUnnamedOnesAreNot) {
    viewer::ViewerConfig config;
    config.bus = bus_options();
    const auto nameless = viewer::Viewer::create(config);
    ASSERT_TRUE(nameless) << nameless.error().message;
    EXPECT_TRUE(viewer::Viewer::create(config));
    config.view.name = "wall";
    const auto first = viewer::Viewer::create(config);
    ASSERT_TRUE(first) << first.error().message;
    const auto second = viewer::Viewer::create(config);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(second.error().message, HasSubstr("viewer 'wall'"));
}

}  // namespace
}  // namespace atrium
