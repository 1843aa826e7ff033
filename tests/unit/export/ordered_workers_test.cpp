#include "tools/export/ordered_workers.hpp"

#include <gtest/gtest.h>

#include <latch>
#include <set>
#include <stdexcept>
#include <vector>

namespace atrium::exporting {
namespace {

TEST(OrderedWorkers, GivesResultsInTheOrderOfTheTasks) {
    OrderedWorkers<int> workers(4);
    std::latch last_is_done(1);
    // the first task ends after the last one
    workers.submit([&](std::size_t) {
        last_is_done.wait();
        return 0;
    });
    for (int i = 1; i < 20; ++i) {
        workers.submit([&, i](std::size_t) {
            if (i == 19) last_is_done.count_down();
            return i;
        });
    }
    EXPECT_EQ(workers.num_open(), 20u);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(workers.take(), i);
    EXPECT_EQ(workers.num_open(), 0u);
}

TEST(OrderedWorkers, GivesTasksAtATimeDifferentNumbers) {
    constexpr std::size_t kWorkers = 3;
    OrderedWorkers<std::size_t> workers(kWorkers);
    std::latch all_are_there(kWorkers);
    for (std::size_t i = 0; i < kWorkers; ++i) {
        workers.submit([&](std::size_t worker) {
            all_are_there.arrive_and_wait();
            return worker;
        });
    }
    std::set<std::size_t> numbers;
    for (std::size_t i = 0; i < kWorkers; ++i) numbers.insert(workers.take());
    EXPECT_EQ(numbers, (std::set<std::size_t>{0, 1, 2}));
}

TEST(OrderedWorkers, PassesExceptionsOnAndGoesOn) {
    OrderedWorkers<int> workers(2);
    workers.submit([](std::size_t) -> int { throw std::runtime_error("no memory"); });
    workers.submit([](std::size_t) { return 7; });
    EXPECT_THROW(workers.take(), std::runtime_error);
    EXPECT_EQ(workers.take(), 7);
}

}  // namespace
}  // namespace atrium::exporting
