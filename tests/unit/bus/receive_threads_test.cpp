#include "core/bus/receive_threads.hpp"

#include "tests/unit/bus/bus_support.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <thread>

namespace atrium::bus {
namespace {

using namespace std::chrono_literals;
using testing::own_world;
using testing::value;

template <typename Condition>
bool eventually(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + 15s;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(1ms);
    }
    return true;
}

TEST(ReceiveThreads, AreFoundAndSleepWithoutTraffic) {
    const auto participant = value(Participant::create(own_world("receive-threads", 129)));
    ReceiveThreads threads;
    EXPECT_FALSE(threads.are_asleep()) << "sleep is not known yet";
    EXPECT_TRUE(eventually([&] { return threads.are_asleep(); }));
    EXPECT_GE(threads.size(), 2U) << "Cyclone DDS uses other thread names";
}

TEST(ReceiveThreads, EndedThreadsBlockNobody) {
    std::optional<ReceiveThreads> threads;
    {
        const auto participant = value(Participant::create(own_world("receive-threads", 129)));
        threads.emplace();
    }
    EXPECT_TRUE(eventually([&] { return threads->are_asleep(); }));
}

TEST(TakeWritten, ReturnsTheWriteTimeOfEachSample) {
    const auto participant = value(Participant::create(own_world("take-written", 129)));
    auto writer = value(Writer<SiteMesh>::create(participant));
    auto reader = value(Reader<SiteMesh>::create(participant));
    ASSERT_TRUE(eventually([&] { return writer.num_readers() == 1; }));
    SiteMesh mesh;
    mesh.site = "lab";
    Timestamp before = Timestamp::now();
    for (mesh.frame_id = 1; mesh.frame_id <= 5; ++mesh.frame_id) {
        mesh.capture_time = Timestamp::now();
        ASSERT_TRUE(writer.write(mesh));
        bool is_taken = false;
        EXPECT_TRUE(eventually([&] {
            reader.take_written([&](SiteMesh&& taken, Timestamp written) {
                is_taken = true;
                EXPECT_EQ(taken.frame_id, mesh.frame_id);
                EXPECT_GE(written, taken.capture_time);
                EXPECT_GE(written, before);
                EXPECT_LE(written, Timestamp::now());
                before = written;
            });
            return is_taken;
        }));
    }
}

}  // namespace
}  // namespace atrium::bus
