#include "tools/calibrate/recording/picture_times.hpp"

#include "tests/support/random.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <functional>

namespace atrium::calibrate {
namespace {

using atrium::test::between;
using atrium::test::Random;

constexpr std::uint64_t kMs = 1'000'000;
constexpr std::uint64_t kStart = 1'779'186'104'123 * kMs;

using Writer = std::function<std::string(std::uint64_t nanoseconds)>;

std::tm utc(std::uint64_t nanoseconds) {
    const auto seconds = static_cast<std::time_t>(nanoseconds / 1'000'000'000);
    std::tm parts{};
    gmtime_r(&seconds, &parts);
    return parts;
}

std::string date_text(std::uint64_t t, const char* form) {
    const std::tm parts = utc(t);
    std::array<char, 64> text{};
    return {text.data(), std::strftime(text.data(), text.size(), form, &parts)};
}

struct Way {
    const char* unit;
    std::uint64_t step_ns;  // what it cannot show
    Writer write;
};

const std::vector<Way>& ways() {
    static const std::vector<Way> all{
        {"milliseconds", kMs, [](auto t) { return fmt::format("{}", t / kMs); }},
        {"microseconds", 1000, [](auto t) { return fmt::format("{}", t / 1000); }},
        {"nanoseconds", 1, [](auto t) { return fmt::format("{}", t); }},
        {"seconds",
         1,
         [](auto t) { return fmt::format("{}.{:09}", t / 1'000'000'000, t % 1'000'000'000); }},
        {"seconds",
         1,
         [](auto t) { return fmt::format("{}_{:09}", t / 1'000'000'000, t % 1'000'000'000); }},
        {"dates",
         kMs,
         [](auto t) {
             return date_text(t, "%Y-%m-%d_%H-%M-%S-") + fmt::format("{:03}", t / kMs % 1000);
         }},
        {"dates",
         1000,
         [](auto t) {
             return date_text(t, "%Y%m%dT%H%M%S_") + fmt::format("{:06}", t / 1000 % 1'000'000);
         }},
        {"dates",
         kMs,
         [](auto t) {
             return date_text(t, "%Y%m%d%H%M%S") + fmt::format("{:03}", t / kMs % 1000);
         }},
        {"dates",
         1000,
         [](auto t) {
             return date_text(t, "%Y-%m-%d %H:%M:%S.") + fmt::format("{:06}", t / 1000 % 1'000'000);
         }},
    };
    return all;
}

std::vector<std::uint64_t> random_times(Random& random) {
    const double period_ns = 1e9 / between(random, 2.0, 120.0);
    std::vector<std::uint64_t> times;
    const auto start = kStart + static_cast<std::uint64_t>(between(random, 0.0, 1e17));
    for (int i = 0; i < 150; ++i) {
        if (between(random, 0, 5) == 0) continue;
        times.push_back(
            start + static_cast<std::uint64_t>(period_ns * (i + between(random, -0.2, 0.2) + 1.0)));
    }
    return times;
}

TEST(PictureTimes, AreFoundHoweverTheyAreWritten) {
    Random random(41);
    constexpr std::array<const char*, 6> kBefore{"", "cam1_", "img-", "640x480_", "take 2 ", "c3"};
    constexpr std::array<const char*, 4> kBehind{"", "_left", "_cam2", "_640x480"};
    for (int round = 0; round < 200; ++round) {
        const Way& way = ways()[static_cast<std::size_t>(round) % ways().size()];
        // a letter's digit before a time would be a part of it
        const std::string before = kBefore[static_cast<std::size_t>(between(random, 0, 4))];
        const std::string behind = kBehind[static_cast<std::size_t>(between(random, 0, 3))];
        const bool has_number = between(random, 0, 2) == 0;
        const std::vector<std::uint64_t> times = random_times(random);
        std::vector<std::string> names;
        for (std::size_t i = 0; i < times.size(); ++i)
            names.push_back(before + (has_number ? fmt::format("f{:06}_", i) : "") +
                            way.write(times[i]) + behind);
        SCOPED_TRACE(names.front());
        const auto split = split_at_times(names);
        ASSERT_TRUE(split);
        for (std::size_t i = 0; i < times.size(); ++i) {
            EXPECT_EQ((*split)[i].number, times[i] / way.step_ns * way.step_ns);
            EXPECT_EQ((*split)[i].prefix, split->front().prefix);
            EXPECT_EQ((*split)[i].tail, behind);
            EXPECT_EQ((*split)[i].time_unit, way.unit);
        }
    }
}

TEST(PictureTimes, OfSeveralCamerasInOneFolderKeepTheCameras) {
    std::vector<std::string> names;
    for (std::uint64_t i = 0; i < 20; ++i)
        for (const char* camera : {"cam1", "cam2", "cam3"})
            names.push_back(fmt::format("{}_{:04}_{}", camera, i, (kStart + i * 67 * kMs) / kMs));
    const auto split = split_at_times(names);
    ASSERT_TRUE(split);
    EXPECT_EQ(split->front().prefix, "cam1");
    EXPECT_EQ(split->back().number, kStart + 19 * 67 * kMs);
}

std::vector<std::string> numbered_names(std::size_t num,
                                        const std::function<std::string(std::size_t)>& name) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < num; ++i) names.push_back(name(i));
    return names;
}

TEST(PictureTimes, AreNotNumbers) {
    const auto none = [](std::size_t num, const std::function<std::string(std::size_t)>& name) {
        const auto names = numbered_names(num, name);
        EXPECT_FALSE(split_at_times(names)) << names.front() << " ... " << names.back();
    };
    none(100, [](std::size_t i) { return fmt::format("{:06}", i); });
    none(100, [](std::size_t i) { return fmt::format("{:013}", i); });
    none(100, [](std::size_t i) { return fmt::format("{}", 10 * i); });
    none(100, [](std::size_t i) { return fmt::format("cam1_{:04}_640x480", i); });
    none(100, [](std::size_t i) { return fmt::format("shot1.{:04}", i); });
    none(100, [](std::size_t i) { return fmt::format("1.{:04}", i); });
    none(120, [](std::size_t i) { return fmt::format("{}.{:04}", i / 30, i % 30); });
    none(120, [](std::size_t i) { return fmt::format("v1.2.{:03}", i); });
    // a serial, the start of the take, or of several takes, before the number
    none(100, [](std::size_t i) { return fmt::format("1779186104123_{:04}", i); });
    none(100, [](std::size_t i) { return fmt::format("2026-05-19_10-21-44_{:04}", i); });
    none(100, [](std::size_t i) { return fmt::format("20260519_102144_{:03}", i); });
    none(90,
         [](std::size_t i) { return fmt::format("20260519_1021{}_{:03}", 40 + i / 30, i % 30); });
    none(90,
         [](std::size_t i) { return fmt::format("2026-05-19_10-2{}-44_{:06}", i / 30, i % 30); });
    none(50, [](std::size_t i) { return fmt::format("20260519_{:06}", i); });
    none(100, [](std::size_t i) { return fmt::format("01-02-03-{:03}", i); });
    // no pattern
    none(3, [](std::size_t i) { return fmt::format("{}", 1'779'186'104'123 + 67 * i); });
    // one picture per camera
    none(5, [](std::size_t i) { return fmt::format("1779186104123_cam{}", i); });
}

TEST(PictureTimes, MayBeInWholeSecondsAndTimesOfDay) {
    const auto seconds = split_at_times(numbered_names(50, [](std::size_t i) {
        return fmt::format("2026-05-19_10-{:02}-{:02}", 21 + (i + 40) / 60, (i + 40) % 60);
    }));
    ASSERT_TRUE(seconds);
    EXPECT_EQ(seconds->at(30).number - seconds->at(0).number, 30'000'000'000U);
    const auto of_day = split_at_times(numbered_names(
        50, [](std::size_t i) { return fmt::format("10-21-{:02}-{:03}", i / 10, i % 10 * 100); }));
    ASSERT_TRUE(of_day);
    EXPECT_EQ(of_day->at(1).number - of_day->at(0).number, 100 * kMs);
    EXPECT_EQ(of_day->at(1).time_unit, "times of day");
}

TEST(PictureTimes, OfPlainNumbersHaveAUnit) {
    const auto unit = [](double step, double jitter) {
        Random random(42);
        std::vector<std::uint64_t> numbers;
        for (int i = 0; i < 30; ++i)
            numbers.push_back(static_cast<std::uint64_t>(
                100.0 + step * (i + 1 + between(random, -jitter, jitter))));
        const auto found = unit_of_numbers({numbers, numbers});
        return found ? std::string(found->name) : std::string();
    };
    EXPECT_EQ(unit(66.7, 0.05), "milliseconds");
    EXPECT_EQ(unit(8.33, 0.05), "milliseconds");
    EXPECT_EQ(unit(33333.3, 0.1), "microseconds");
    EXPECT_EQ(unit(33333333.3, 0.1), "nanoseconds");
    EXPECT_EQ(unit(1.0, 0.0), "");
    EXPECT_EQ(unit(66.7, 0.49), "") << "uneven";
    EXPECT_FALSE(unit_of_numbers({{0, 67, 133}, {0, 67, 133}})) << "few";
    EXPECT_FALSE(unit_of_numbers({}));
}

}  // namespace
}  // namespace atrium::calibrate
