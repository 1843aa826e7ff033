#include "tools/calibrate/recording/time_grid.hpp"

#include "tests/support/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace atrium::calibrate {
namespace {

using atrium::test::between;
using atrium::test::Random;

// Cameras that take pictures together, and the true instant of each picture.
struct Taken {
    CameraTimes times;
    std::map<std::string, std::map<std::uint64_t, std::size_t>> instants;
    double period_ns = 0.0;
};

struct Faults {
    double jitter = 0.0;  // at most, of a period
    double offset = 0.0;  // of a camera, at most, of a period
    double lost = 0.0;    // share of the pictures
    double drift = 0.0;   // of the period over the whole time
    double unit_ns = 1.0;
};

Taken take_pictures(
    Random& random, int num_cameras, int num_instants, double rate_hz, const Faults& faults) {
    Taken taken;
    taken.period_ns = 1e9 / rate_hz;
    const double start = between(random, 1e9, 1.9e18);
    for (int c = 0; c < num_cameras; ++c) {
        const std::string name = "cam" + std::to_string(c);
        const double offset = between(random, -faults.offset, faults.offset);
        const int first = between(random, 0, num_instants / 5);
        for (int i = first; i < num_instants; ++i) {
            const double drifted = i * (1.0 + 0.5 * faults.drift * i / num_instants);
            const double at = drifted + offset + between(random, -faults.jitter, faults.jitter);
            if (between(random, 0.0, 1.0) < faults.lost) continue;
            const double units = std::round((start + at * taken.period_ns) / faults.unit_ns);
            const auto time = static_cast<std::uint64_t>(units * faults.unit_ns);
            taken.times[name].push_back(time);
            taken.instants[name][time] = static_cast<std::size_t>(i);
        }
        std::ranges::sort(taken.times[name]);
    }
    return taken;
}

// The numbers are the true instants, counted from any one.
void expect_true(const Taken& taken, const TimeGrid& grid) {
    std::set<std::int64_t> shifts;
    std::size_t num = 0;
    for (const auto& [camera, numbers] : grid.numbers) {
        for (const auto& [time, number] : numbers) {
            const std::size_t instant = taken.instants.at(camera).at(time);
            shifts.insert(static_cast<std::int64_t>(number) - static_cast<std::int64_t>(instant));
            ++num;
        }
    }
    EXPECT_EQ(shifts.size(), 1U);
    std::size_t num_taken = 0;
    for (const auto& [camera, times] : taken.times) num_taken += times.size();
    EXPECT_EQ(num, num_taken);
    EXPECT_EQ(grid.num_beside, 0U);
}

TEST(TimeGrid, OfManyRandomCamerasIsTheTruth) {
    Random random(31);
    for (int round = 0; round < 200; ++round) {
        const int num_cameras = between(random, 2, 9);
        const int num_instants = between(random, 12, 400);
        const double rate_hz = std::pow(10.0, between(random, 0.0, 2.0));
        Faults faults;
        faults.jitter = between(random, 0.0, 0.25);
        faults.offset = between(random, 0.0, 0.1);
        faults.lost = between(random, 0.0, 0.25);
        faults.unit_ns = round % 3 == 0 ? 1e6 : 1.0;
        SCOPED_TRACE(testing::Message()
                     << "round " << round << ": " << num_cameras << " cameras, " << num_instants
                     << " instants, " << rate_hz << " Hz, jitter " << faults.jitter << ", offset "
                     << faults.offset << ", lost " << faults.lost);
        const Taken taken = take_pictures(random, num_cameras, num_instants, rate_hz, faults);
        const auto grid = grid_of(taken.times);
        ASSERT_TRUE(grid);
        expect_true(taken, *grid);
        EXPECT_NEAR(grid->period_ns / taken.period_ns, 1.0, 0.6 / num_instants);
    }
}

TEST(TimeGrid, BearsAThirdOfAPeriodOfJitter) {
    Random random(32);
    for (int round = 0; round < 50; ++round) {
        const Taken taken = take_pictures(random, 4, 200, 15.0, {.jitter = 0.33});
        const auto grid = grid_of(taken.times);
        ASSERT_TRUE(grid);
        expect_true(taken, *grid);
    }
}

TEST(TimeGrid, FollowsAPeriodThatChangesSlowly) {
    Random random(33);
    for (int round = 0; round < 8; ++round) {
        const Taken taken = take_pictures(
            random, 3, 5000, 30.0, {.jitter = 0.15, .offset = 0.1, .lost = 0.1, .drift = 0.05});
        const auto grid = grid_of(taken.times);
        ASSERT_TRUE(grid);
        expect_true(taken, *grid);
    }
}

TEST(TimeGrid, KnowsTheOffsetOfACamera) {
    CameraTimes times;
    for (std::uint64_t i = 0; i < 40; ++i) {
        times["a"].push_back(i * 100);
        times["b"].push_back(i * 100);
        times["late"].push_back(i * 100 + 30);
    }
    const auto grid = grid_of(times);
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->numbers.at("late").at(30), 0U);
    EXPECT_NEAR(grid->offset_ns.at("late"), 30.0, 1.0);
    EXPECT_NEAR(grid->period_ns, 100.0, 0.01);
}

TEST(TimeGrid, KeepsThePictureThatIsNearerToItsInstant) {
    CameraTimes times;
    for (std::uint64_t i = 0; i < 40; ++i) {
        times["a"].push_back(1000 + i * 100);
        times["b"].push_back(1000 + i * 100);
    }
    times["b"].insert(times["b"].begin() + 5, 1430);
    const auto grid = grid_of(times);
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->num_beside, 1U);
    EXPECT_FALSE(grid->numbers.at("b").contains(1430));
    EXPECT_EQ(grid->numbers.at("b").at(1500), grid->numbers.at("a").at(1500));
}

TEST(TimeGrid, NeedsFourPicturesOfSomeCamera) {
    EXPECT_FALSE(grid_of({{"a", {0, 100, 200}}, {"b", {0, 100, 200}}}));
    EXPECT_FALSE(grid_of({}));
    EXPECT_TRUE(grid_of({{"a", {0, 100, 200, 300}}, {"b", {100}}}));
}

}  // namespace
}  // namespace atrium::calibrate
