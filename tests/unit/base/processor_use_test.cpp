#include "core/base/processor_use.hpp"

#include "tests/support/skips.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace atrium {
namespace {

namespace fs = std::filesystem;
using Clock = ProcessorMeter::Clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(ParseSchedstat, ReadsThreeNumbers) {
    const auto stat = parse_schedstat("101933437 32335820 109\n");
    ASSERT_TRUE(stat.has_value());
    EXPECT_EQ(stat->run_ns, 101933437U);
    EXPECT_EQ(stat->waited_ns, 32335820U);
    EXPECT_EQ(stat->num_runs, 109U);
    EXPECT_TRUE(parse_schedstat("0 108924 1\n").has_value())
        << "the thread is still in its first run";
    EXPECT_TRUE(parse_schedstat("18446744073709551615 0 1").has_value());
}

TEST(ParseSchedstat, RefusesMalformedLines) {
    for (const char* text : {"",
                             "\n",
                             "1",
                             "1 2",
                             "1 2 ",
                             "1 2 x",
                             "1 2 3x",
                             "1 2 3 4",
                             "1 2 3\n4",
                             "-1 2 3",
                             "1.5 2 3",
                             "1,2,3",
                             "18446744073709551616 2 3"}) {
        EXPECT_FALSE(parse_schedstat(text).has_value()) << '"' << text << '"';
    }
}

TEST(ParseSchedstat, ReadsZerosAsAKernelThatDoesNotCount) {
    EXPECT_FALSE(parse_schedstat("0 0 0\n").has_value());
}

// A folder like /proc/self/task.
class ProcessorMeterTest : public testing::Test {
protected:
    ProcessorMeterTest() { fs::create_directories(folder_); }
    ~ProcessorMeterTest() override { fs::remove_all(folder_); }

    void thread(int id, const std::string& schedstat) const {
        fs::create_directories(folder_ / std::to_string(id));
        std::ofstream(folder_ / std::to_string(id) / "schedstat") << schedstat;
    }
    void thread(int id, std::uint64_t run_ns, std::uint64_t waited_ns) const {
        thread(id, std::to_string(run_ns) + " " + std::to_string(waited_ns) + " 7\n");
    }
    void end_thread(int id) const { fs::remove_all(folder_ / std::to_string(id)); }

    const fs::path folder_ =
        fs::path(testing::TempDir()) /
        ("processor_meter_" + std::to_string(getpid()) + "_" +
         std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    Clock::time_point now_{seconds(1000)};
};

TEST_F(ProcessorMeterTest, SumsTheWaitsOfAllThreads) {
    thread(10, 500, 1'000'000'000);
    thread(11, 500, 2'000'000'000);
    ProcessorMeter meter(folder_.string(), now_);
    thread(10, 900, 1'200'000'000);
    thread(11, 900, 2'700'000'000);
    const ProcessorUse use = meter.update(now_ + seconds(2));
    EXPECT_TRUE(use.is_waiting_known);
    EXPECT_EQ(use.waited_ns, 3'900'000'000U);
    EXPECT_DOUBLE_EQ(use.waited_per_s, 0.45);
    EXPECT_DOUBLE_EQ(use.longest_wait_per_s, 0.35);
}

// A program's first report follows its start immediately, and late reports follow each other
// immediately.
TEST_F(ProcessorMeterTest, IgnoresIntervalsOfAFewMilliseconds) {
    thread(10, 500, 0);
    ProcessorMeter meter(folder_.string(), now_);
    thread(10, 900, 90'000'000);
    const ProcessorUse first = meter.update(now_ + milliseconds(100));
    EXPECT_EQ(first.longest_wait_per_s, 0.0) << "90 ms of 100";
    EXPECT_TRUE(first.is_waiting_known);
    const ProcessorUse second = meter.update(now_ + milliseconds(1000));
    EXPECT_DOUBLE_EQ(second.longest_wait_per_s, 0.09) << "the wait of the ignored interval is lost";
    thread(10, 1'000, 5'090'000'000);
    EXPECT_EQ(meter.update(now_ + milliseconds(1001)), second);
    // the wait began before the interval: no thread can wait longer than the interval lasts
    const ProcessorUse third = meter.update(now_ + milliseconds(2000));
    EXPECT_DOUBLE_EQ(third.longest_wait_per_s, 1.0);
    EXPECT_EQ(third.waited_ns, 5'090'000'000U);
}

TEST_F(ProcessorMeterTest, KeepsTheWaitsOfEndedThreads) {
    thread(10, 500, 100);
    thread(11, 500, 2'000'000'000);
    ProcessorMeter meter(folder_.string(), now_);
    end_thread(11);
    thread(12, 10, 400);
    EXPECT_EQ(meter.update(now_ + seconds(1)).waited_ns, 2'000'000'500U);
    end_thread(12);
    EXPECT_EQ(meter.update(now_ + seconds(2)).waited_ns, 2'000'000'500U);
}

TEST_F(ProcessorMeterTest, CountsANewThreadThatReusesAnEndedThreadsId) {
    thread(10, 5'000, 1'000);
    ProcessorMeter meter(folder_.string(), now_);
    thread(10, 20, 300);  // it ran for less time than the old thread
    EXPECT_EQ(meter.update(now_ + seconds(1)).waited_ns, 1'300U);
}

TEST_F(ProcessorMeterTest, NeverDecreases) {
    std::mt19937 random(1);
    ProcessorMeter meter(folder_.string(), now_);
    ProcessorUse last;
    for (int second = 1; second <= 300; ++second) {
        const int id = static_cast<int>(random() % 8);
        if (random() % 3 == 0)
            end_thread(id);
        else
            thread(id, random(), random());
        const ProcessorUse use = meter.update(now_ + seconds(second));
        EXPECT_GE(use.waited_ns, last.waited_ns);
        EXPECT_GE(use.run_ns, last.run_ns);
        EXPECT_GE(use.waited_per_s, use.longest_wait_per_s);
        last = use;
    }
}

TEST_F(ProcessorMeterTest, ReportsAKernelThatDoesNotCount) {
    thread(10, "0 0 0\n");
    ProcessorMeter zeros(folder_.string(), now_);
    EXPECT_FALSE(zeros.update(now_ + seconds(1)).is_waiting_known);
    fs::remove(folder_ / "10" / "schedstat");
    ProcessorMeter no_files(folder_.string(), now_);
    EXPECT_FALSE(no_files.update(now_ + seconds(1)).is_waiting_known);
    ProcessorMeter no_folder((folder_ / "none").string(), now_);
    const ProcessorUse use = no_folder.update(now_ + seconds(1));
    EXPECT_FALSE(use.is_waiting_known);
    EXPECT_GT(use.run_ns, 0U) << "the run time needs no schedstat";
}

TEST_F(ProcessorMeterTest, CountsNothingTwiceAfterAnUnreadableFile) {
    thread(10, 500, 1'000);
    ProcessorMeter meter(folder_.string(), now_);
    thread(10, "");
    EXPECT_EQ(meter.update(now_ + seconds(1)).waited_ns, 1'000U);
    thread(10, 600, 1'100);
    EXPECT_EQ(meter.update(now_ + seconds(2)).waited_ns, 1'100U);
}

// Runs `thread` while more busy threads than cores compete with it.
template <typename Thread>
void run_among_busy_threads(Thread thread) {
    std::atomic<bool> stop{false};
    std::vector<std::jthread> busy;
    for (unsigned i = 0; i < 2 * std::thread::hardware_concurrency() + 1; ++i) {
        busy.emplace_back([&stop] {
            while (!stop) {
            }
        });
    }
    thread();
    stop = true;
}

bool kernel_counts() { return ProcessorMeter().update().is_waiting_known; }

TEST(ProcessorMeterOfThisProcess, MeasuresItsThreadsRunAndWait) {
    ProcessorMeter meter;
    run_among_busy_threads([] { std::this_thread::sleep_for(milliseconds(200)); });
    const ProcessorUse use = meter.update();
    EXPECT_GT(use.run_per_s, 0.1);
    if (!kernel_counts()) GTEST_SKIP() << atrium::test::skip::kNoWaitTimes;
    // the busy threads have ended before the meter could see them
    ProcessorMeter again;
    ProcessorUse during;
    run_among_busy_threads([&] {
        std::this_thread::sleep_for(milliseconds(300));
        during = again.update();
    });
    EXPECT_GT(during.waited_per_s, 0.3) << "two threads per core must wait";
    EXPECT_LE(during.longest_wait_per_s, 1.0);
}

}  // namespace
}  // namespace atrium
