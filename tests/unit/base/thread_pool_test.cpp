#include "core/base/thread_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <numeric>
#include <optional>
#include <thread>
#include <vector>

namespace atrium {
namespace {

TEST(ThreadPool, RunsEachTaskOncePerRound) {
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

TEST(ThreadPool, ConcurrentTasksHaveDifferentWorkers) {
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

TEST(ThreadPool, CallerSeesTheResults) {
    ThreadPool pool(3);
    std::vector<std::uint64_t> squares(10000);
    const auto body = [&](std::size_t task, std::size_t) { squares[task] = task * task; };
    pool.parallel_for(squares.size(), body);
    for (std::size_t i = 0; i < squares.size(); ++i) ASSERT_EQ(squares[i], i * i);
}

TEST(ThreadPool, RethrowsToTheCallerAndStaysUsable) {
    for (const std::size_t num_workers : {1u, 2u, 5u}) {
        ThreadPool pool(num_workers);
        for (const std::size_t bad_task : {0u, 50u, 99u}) {
            const auto body = [&](std::size_t task, std::size_t) {
                if (task >= bad_task) throw std::bad_alloc();  // thrown by several workers at once
            };
            EXPECT_THROW(pool.parallel_for(100, body), std::bad_alloc) << num_workers;
            std::atomic<int> num_done{0};
            const auto next = [&](std::size_t, std::size_t) { ++num_done; };
            pool.parallel_for(100, next);
            EXPECT_EQ(num_done, 100);
        }
    }
}

// Number of threads inside a task now, and its maximum so far.
class Crowd {
public:
    class Member {
    public:
        explicit Member(Crowd& crowd) : crowd_(crowd) {
            const int now = crowd_.num_now_.fetch_add(1) + 1;
            int most = crowd_.most_.load();
            while (now > most && !crowd_.most_.compare_exchange_weak(most, now)) {
            }
        }
        ~Member() { crowd_.num_now_.fetch_sub(1); }

    private:
        Crowd& crowd_;
    };
    int most() const { return most_; }

private:
    std::atomic<int> num_now_{0};
    std::atomic<int> most_{0};
};

TEST(ThreadPool, RunsEachTaskOfTwoCallersOnce) {
    constexpr int kNumRounds = 300;
    constexpr std::size_t kNumTasks = 40;
    for (const std::size_t num_workers : {1u, 2u, 4u}) {
        ThreadPool pool(num_workers);
        EXPECT_EQ(pool.background().num_workers(), num_workers);
        std::vector<std::atomic<int>> background(kNumTasks);
        std::vector<std::atomic<int>> urgent(kNumTasks);
        std::atomic<bool> shared{false};
        std::jthread other([&] {
            std::vector<std::atomic<int>> busy(num_workers);
            const auto body = [&](std::size_t task, std::size_t worker) {
                if (busy[worker].fetch_add(1) != 0) shared = true;
                for (int i = 0; i < 5; ++i) pool.background().give_way(worker);
                busy[worker].fetch_sub(1);
                ++background[task];
            };
            for (int round = 0; round < kNumRounds; ++round)
                pool.background().parallel_for(kNumTasks, body);
        });
        std::vector<std::atomic<int>> busy(num_workers);
        const auto body = [&](std::size_t task, std::size_t worker) {
            if (busy[worker].fetch_add(1) != 0) shared = true;
            busy[worker].fetch_sub(1);
            ++urgent[task];
        };
        for (int round = 0; round < kNumRounds; ++round) {
            const ThreadPool::Priority priority(pool);
            pool.parallel_for(kNumTasks, body);
        }
        other.join();
        EXPECT_FALSE(shared);
        for (const auto& n : background) EXPECT_EQ(n, kNumRounds);
        for (const auto& n : urgent) EXPECT_EQ(n, kNumRounds);
    }
}

// Both tasks of an urgent round wait for each other. The only pool thread is busy with a background
// task, and the round can end only if that task gives way.
TEST(ThreadPool, BackgroundTaskGivesWayBeforeItEnds) {
    ThreadPool pool(2);
    std::atomic<int> num_begun{0};
    std::atomic<bool> urgent_done{false};
    std::optional<ThreadPool::Priority> priority(pool);
    std::jthread other([&] {
        const auto body = [&](std::size_t, std::size_t worker) {
            ++num_begun;
            num_begun.notify_all();
            while (!urgent_done) pool.background().give_way(worker);
        };
        pool.background().parallel_for(1, body);
    });
    num_begun.wait(0);  // on the pool thread, because somebody holds the priority
    std::atomic<int> num_met{0};
    const auto meet = [&](std::size_t, std::size_t) {
        ++num_met;
        num_met.notify_all();
        for (int n = num_met; n < 2; n = num_met) num_met.wait(n);
    };
    pool.parallel_for(2, meet);
    urgent_done = true;
    other.join();
    EXPECT_EQ(num_met, 2);
}

TEST(ThreadPool, BackgroundCallerWorksOnlyWithoutPriorityHolders) {
    ThreadPool alone(1);
    std::optional<ThreadPool::Priority> priority(alone);
    std::atomic<int> num_done{0};
    std::jthread other([&] {
        const auto body = [&](std::size_t, std::size_t) { ++num_done; };
        alone.background().parallel_for(10, body);
    });
    const auto urgent = [&](std::size_t, std::size_t) { EXPECT_EQ(num_done, 0); };
    for (int i = 0; i < 1000; ++i) alone.parallel_for(3, urgent);
    ThreadPool::Priority moved(std::move(*priority));
    priority.reset();  // the moved-from one
    alone.parallel_for(3, urgent);
    moved = ThreadPool::Priority();
    other.join();
    EXPECT_EQ(num_done, 10);
}

TEST(ThreadPool, RunsNoMoreThreadsThanWorkers) {
    constexpr std::size_t kNumWorkers = 3;
    ThreadPool pool(kNumWorkers);
    Crowd crowd;
    std::atomic<bool> ends{false};
    std::optional<ThreadPool::Priority> priority(pool);  // held during the whole test
    std::jthread other([&] {
        const auto body = [&](std::size_t, std::size_t) { const Crowd::Member member(crowd); };
        while (!ends) pool.background().parallel_for(20, body);
    });
    const auto urgent = [&](std::size_t, std::size_t) { const Crowd::Member member(crowd); };
    for (int round = 0; round < 500; ++round) pool.parallel_for(20, urgent);
    ends = true;
    priority.reset();
    other.join();
    EXPECT_LE(crowd.most(), static_cast<int>(kNumWorkers));
}

TEST(ThreadPool, RethrowsToTheBackgroundCaller) {
    for (const std::size_t num_workers : {1u, 2u, 5u}) {
        ThreadPool pool(num_workers);
        const auto bad = [&](std::size_t task, std::size_t) {
            if (task >= 50) throw std::bad_alloc();
        };
        EXPECT_THROW(pool.background().parallel_for(100, bad), std::bad_alloc);
        std::atomic<int> num_done{0};
        const auto next = [&](std::size_t, std::size_t) { ++num_done; };
        pool.background().parallel_for(100, next);
        EXPECT_EQ(num_done, 100);
    }
}

TEST(ThreadPool, CanBeDestroyedUnused) { const ThreadPool pool(8); }

}  // namespace
}  // namespace atrium
