#include "site_node/capture/camera_clock.hpp"

#include "site_node/capture/camera_settings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace atrium::capture {
namespace {

constexpr std::int64_t kPicturePeriod_ns = 33'000'000;
constexpr std::int64_t kEpoch_ns = 1'800'000'000'000'000'000;
constexpr std::chrono::nanoseconds kNever{0};  // the site's clock is never set

TEST(CameraClock, UsesArrivalTimesWithoutADeviceClock) {
    CameraClock clock;
    EXPECT_EQ(clock.on_site_clock(0, {kEpoch_ns}, kNever).ns, kEpoch_ns);
    EXPECT_EQ(clock.on_site_clock(0, {kEpoch_ns + 7}, kNever).ns, kEpoch_ns + 7);
}

TEST(CameraClock, LateArrivalsDoNotShiftCaptureTimes) {
    std::mt19937 random(5);
    CameraClock clock;
    std::vector<std::int64_t> errors_ns;
    for (int i = 0; i < 2000; ++i) {
        const std::int64_t device_ns = 1'000'000 + i * kPicturePeriod_ns;
        const std::int64_t true_ns = kEpoch_ns + device_ns + device_ns / 20'000;  // 50 ppm apart
        // the delay is mostly 1 ms, and sometimes up to a period more
        const std::int64_t delay_ns =
            1'000'000 + (random() % 5 == 0 ? static_cast<std::int64_t>(random() % 33'000'000)
                                           : static_cast<std::int64_t>(random() % 200'000));
        const Timestamp t = clock.on_site_clock(
            static_cast<std::uint64_t>(device_ns), {true_ns + delay_ns}, kNever);
        if (i >= 10) errors_ns.push_back(t.ns - true_ns);
    }
    const auto [least, most] = std::minmax_element(errors_ns.begin(), errors_ns.end());
    EXPECT_GE(*least, 1'000'000 - 100'000);
    EXPECT_LE(*most, 1'000'000 + 300'000);
}

TEST(CameraClock, FollowsAClockThatWasSet) {
    CameraClock clock;
    clock.on_site_clock(5'000'000'000'000, {kEpoch_ns}, kNever);
    EXPECT_EQ(clock.on_site_clock(1'000, {kEpoch_ns + kPicturePeriod_ns}, kNever).ns,
              kEpoch_ns + kPicturePeriod_ns);
    // it keeps that pace, although the next picture arrives late
    const auto next = clock.on_site_clock(
        1'000 + kPicturePeriod_ns, {kEpoch_ns + 2 * kPicturePeriod_ns + 9'000'000}, kNever);
    EXPECT_NEAR(static_cast<double>(next.ns - kEpoch_ns),
                2.0 * kPicturePeriod_ns,
                CameraClock::kMaxDrift * (kPicturePeriod_ns + 9'000'000));
}

// A time daemon changes the rate of the site's clock by up to 8 %, or sets it, also between the
// arrival of a picture and its handling. The times of pictures follow at once.
TEST(CameraClock, FollowsASiteClockThatIsSlewedOrSet) {
    for (std::uint32_t seed = 0; seed < 50; ++seed) {
        std::mt19937 random(seed);
        CameraClock clock;
        double ahead_ns = 0.0;  // the site's clock, of the true time
        double rate = 0.0;
        for (int i = 0; i < 1000; ++i) {
            const std::int64_t device_ns = 1'000'000 + i * kPicturePeriod_ns;
            if (random() % 50 == 0) rate = (static_cast<double>(random() % 161) - 80.0) * 1e-3;
            if (random() % 50 == 0) rate = 0.0;
            ahead_ns += rate * kPicturePeriod_ns;
            const std::int64_t raw_ns = device_ns + 77'000'000'000;
            const auto delay_ns = static_cast<std::int64_t>(random() % 200'000);
            const std::int64_t arrival_ns =
                kEpoch_ns + raw_ns + delay_ns + static_cast<std::int64_t>(ahead_ns);
            if (i > 10 && rate == 0.0 && random() % 40 == 0)
                ahead_ns +=
                    (random() % 2 == 0 ? 1.0 : -1.0) * static_cast<double>(random() % 40) * 1e6;
            const std::chrono::nanoseconds site_minus_raw(kEpoch_ns +
                                                          static_cast<std::int64_t>(ahead_ns));
            const Timestamp t = clock.on_site_clock(
                static_cast<std::uint64_t>(device_ns), {arrival_ns}, site_minus_raw);
            const std::int64_t true_ns = raw_ns + site_minus_raw.count();
            ASSERT_NEAR(static_cast<double>(t.ns - true_ns), 0.0, 500'000.0) << seed << " " << i;
        }
    }
}

TEST(BackwardsGuard, RefusesOlderOrEqualTimes) {
    BackwardsGuard guard;
    EXPECT_TRUE(guard.accept(10));
    EXPECT_FALSE(guard.accept(10));
    EXPECT_FALSE(guard.accept(4));
    EXPECT_TRUE(guard.accept(11));
}

TEST(BackwardsGuard, AcceptsAClockThatWasSetBackAfterAWhile) {
    BackwardsGuard guard;
    EXPECT_TRUE(guard.accept(1'000'000));
    for (int i = 0; i < BackwardsGuard::kMaxRefused; ++i)
        EXPECT_FALSE(guard.accept(static_cast<std::uint64_t>(10 + i)));
    EXPECT_TRUE(guard.accept(100));
    EXPECT_TRUE(guard.accept(101));
}

TEST(BackwardsGuard, NeverAcceptsOldPicturesThatDisagree) {
    BackwardsGuard guard;
    EXPECT_TRUE(guard.accept(1'000'000));
    for (int i = 0; i < 100; ++i)
        EXPECT_FALSE(guard.accept(static_cast<std::uint64_t>(i % 3 == 0 ? 10 : 10 + i % 3)));
}

TEST(CameraSettings, OwnSettingsOverrideCommonOnes) {
    CameraSettings common;
    common.pixel_format = "BayerRG8";
    common.exposure_us = 5000.0;
    common.packet_delay_ns = 1000;
    CameraSettings own;
    own.exposure_us = 7000.0;
    own.region_px = {1, 2, 3, 4};
    own.packet_delay_ns = 0;
    const CameraSettings result = merged(common, own);
    EXPECT_EQ(result.pixel_format, "BayerRG8");
    EXPECT_EQ(result.exposure_us, 7000.0);
    EXPECT_EQ(result.region_px, own.region_px);
    EXPECT_EQ(result.packet_delay_ns, 0);
    EXPECT_LT(result.gain_db, 0.0);
}

}  // namespace
}  // namespace atrium::capture
