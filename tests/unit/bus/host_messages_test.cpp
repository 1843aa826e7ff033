#include "core/bus/limits.hpp"
#include "core/bus/messages.hpp"
#include "core/bus/names.hpp"
#include "tests/unit/bus/wire_damage.hpp"

#include <gtest/gtest.h>

#include <random>

namespace atrium::bus {
namespace {

using testing::expect_each_refused;

TEST(SiteOrders, WithoutAnyEveryTextureIsWanted) {
    EXPECT_TRUE(is_texture_wanted({}, {5}));
    EXPECT_TRUE(is_texture_wanted({}, {-5}));
}

// Whatever the host's clock, within half a period: one of `send_every` instants, the right one.
TEST(SiteOrders, OneOfSoManyInstantsIsWanted) {
    std::mt19937_64 random(3);
    constexpr std::int64_t kPeriod_ns = 33'333'333;
    for (std::uint32_t every = 2; every <= kMaxSendEvery; ++every) {
        SiteOrders orders;
        orders.send_every = every;
        orders.sent = {1'700'000'000'000'000'000};
        orders.period = std::chrono::nanoseconds(kPeriod_ns);
        for (std::int64_t instant = -100; instant < 100; ++instant) {
            std::uniform_int_distribution<std::int64_t> off_ns(-kPeriod_ns * 45 / 100,
                                                               kPeriod_ns * 45 / 100);
            const Timestamp time{orders.sent.ns + instant * kPeriod_ns + off_ns(random)};
            EXPECT_EQ(is_texture_wanted(orders, time), instant % every == 0)
                << every << " " << instant;
        }
    }
}

TEST(SiteOrders, ExtremeTimesDoNoHarm) {
    SiteOrders orders;
    orders.send_every = 2;
    for (const std::int64_t sent : {std::int64_t{0}, kMaxTime_ns}) {
        for (const std::int64_t period : {std::int64_t{0}, kMaxTime_ns}) {
            orders.sent = {sent};
            orders.period = std::chrono::nanoseconds(period);
            for (const std::int64_t time : {std::int64_t{0}, kMaxTime_ns})
                is_texture_wanted(orders, {time});
        }
    }
}

TEST(FromWire, RefusesEachBadFieldOfARegionOrder) {
    using W = atrium_RegionOrder;
    static std::uint32_t two_equal[] = {3, 3};
    static std::uint32_t too_many[] = {1, 0xffffffff};
    RegionOrder order;
    order.site = "hall";
    order.host = "north";
    order.cameras = {2, 5};
    order.contour_counts = {1, 0};
    order.contour_sizes = {3};
    order.vertices_px = {{0, 0}, {1, 0}, {0, 1}};
    expect_each_refused<RegionOrder>(
        order,
        {{"cameras", [](W& w) { w.cameras._buffer = two_equal; }},
         {"contour_counts", [](W& w) { w.contour_counts._length = 1; }},
         {"contour_sizes", [](W& w) { w.contour_counts._buffer = too_many; }},
         {"contour_sizes", [](W& w) { w.contour_sizes._length = 0; }},
         {"vertices_px", [](W& w) { w.contour_sizes._buffer = &too_many[1]; }},
         {"vertices_px", [](W& w) { w.vertices_px._length = 4; }}});
}

TEST(AsLine, MakesAnyTextALine) {
    EXPECT_EQ(as_line("plain"), "plain");
    EXPECT_EQ(as_line("a\nb\xc3\xa4"), "a?b??");
    for (const std::string& text :
         {std::string(300, 'x'), std::string(200, 'x') + " " + std::string(100, 'y')}) {
        EXPECT_TRUE(is_valid_line(as_line(text)));
        EXPECT_TRUE(as_line(text).ends_with("..."));
    }
}

TEST(FromWire, RefusesEachBadFieldOfRegionMeshes) {
    using W = atrium_RegionMeshes;
    RegionMeshes meshes;
    meshes.site = "hall";
    meshes.host = "north";
    meshes.regions = {{0, RegionOutcome::kMesh, 2}, {1, RegionOutcome::kNobody, 0}};
    meshes.draco = {1, 2};
    expect_each_refused<RegionMeshes>(
        meshes,
        {{"regions", [](W& w) { w.regions._buffer[1].region = 0; }},
         {"regions", [](W& w) { w.regions._buffer[1].region = 64; }},
         {"regions", [](W& w) { w.regions._buffer[1].outcome = 4; }},
         {"regions", [](W& w) { w.regions._buffer[1].outcome = 1; }},
         {"regions", [](W& w) { w.regions._buffer[1].num_bytes = 0xffffffff; }},
         {"regions", [](W& w) { w.regions._buffer[0].num_bytes = 1; }},
         {"draco", [](W& w) { w.draco._length = kMaxCodedBytes + 1; }}});
}

}  // namespace
}  // namespace atrium::bus
