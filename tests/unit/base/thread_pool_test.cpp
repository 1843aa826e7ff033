#include "core/base/thread_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <numeric>
#include <vector>

namespace atrium {
namespace {

TEST(ThreadPool, DoesEachTaskOnceInEveryRound) {
    for (const std::size_t num_workers : {1u, 2u, 5u}) {
        ThreadPool pool(num_workers);
        EXPECT_EQ(pool.num_workers(), num_workers);
        for (const std::size_t num_tasks : {0u, 1u, 3u, 1000u}) {
            std::vector<int> times_done(num_tasks, 0);
            const auto body = [&](std::size_t task, std::size_t worker) {
                EXPECT_LT(worker, num_workers);
                ++times_done[task];
            };
            pool.parallel_for(num_tasks, body);
            EXPECT_EQ(std::accumulate(times_done.begin(), times_done.end(), std::size_t{0}),
                      num_tasks);
            for (const int n : times_done) EXPECT_EQ(n, 1);
        }
    }
}

TEST(ThreadPool, NoTwoTasksAtOnceHaveTheSameWorker) {
    constexpr std::size_t kNumWorkers = 4;
    ThreadPool pool(kNumWorkers);
    std::vector<std::atomic<int>> busy(kNumWorkers);
    std::atomic<bool> shared{false};
    const auto body = [&](std::size_t, std::size_t worker) {
        if (busy[worker].fetch_add(1) != 0) shared = true;
        busy[worker].fetch_sub(1);
    };
    for (int round = 0; round < 200; ++round) pool.parallel_for(50, body);
    EXPECT_FALSE(shared);
}

TEST(ThreadPool, ResultsAreSeenByTheCaller) {
    ThreadPool pool(3);
    std::vector<std::uint64_t> squares(10000);
    const auto body = [&](std::size_t task, std::size_t) { squares[task] = task * task; };
    pool.parallel_for(squares.size(), body);
    for (std::size_t i = 0; i < squares.size(); ++i) ASSERT_EQ(squares[i], i * i);
}

TEST(ThreadPool, GivesTheCallerWhatABodyThrowsAndGoesOn) {
    for (const std::size_t num_workers : {1u, 2u, 5u}) {
        ThreadPool pool(num_workers);
        for (const std::size_t bad_task : {0u, 50u, 99u}) {
            const auto body = [&](std::size_t task, std::size_t) {
                if (task >= bad_task) throw std::bad_alloc();  // of several workers at once
            };
            EXPECT_THROW(pool.parallel_for(100, body), std::bad_alloc) << num_workers;
            std::atomic<int> num_done{0};
            const auto next = [&](std::size_t, std::size_t) { ++num_done; };
            pool.parallel_for(100, next);
            EXPECT_EQ(num_done, 100);
        }
    }
}

TEST(ThreadPool, MayBeDestroyedWithoutEverBeingUsed) { const ThreadPool pool(8); }

}  // namespace
}  // namespace atrium
