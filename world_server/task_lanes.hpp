#pragma once

#include <pthread.h>

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <future>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

namespace atrium::world_server {

/// Runs tasks on threads. Each lane is one thread, which runs its tasks in the order of their
/// `put`. The caller bounds the number of waiting tasks.
template <typename Result>
class TaskLanes {
public:
    /// `num_lanes` 0 means 1.
    explicit TaskLanes(std::size_t num_lanes) : lanes_(std::max<std::size_t>(1, num_lanes)) {
        for (Lane& lane : lanes_) {
            lane.thread = std::jthread([&lane](std::stop_token stop) { run(lane, stop); });
            pthread_setname_np(lane.thread.native_handle(), "prepare");
        }
    }

    std::size_t num_lanes() const { return lanes_.size(); }

    std::future<Result> put(std::size_t lane, std::packaged_task<Result()> task) {
        std::future<Result> result = task.get_future();
        {
            const std::lock_guard lock(lanes_[lane].mutex);
            lanes_[lane].tasks.push_back(std::move(task));
        }
        lanes_[lane].changed.notify_one();
        return result;
    }

private:
    struct Lane {
        std::mutex mutex;
        std::condition_variable_any changed;
        std::deque<std::packaged_task<Result()>> tasks;  // guarded by mutex
        std::jthread thread;                             // last: it uses the rest
    };

    static void run(Lane& lane, const std::stop_token& stop) {
        std::unique_lock lock(lane.mutex);
        while (lane.changed.wait(lock, stop, [&lane] { return !lane.tasks.empty(); })) {
            if (stop.stop_requested()) return;
            auto task = std::move(lane.tasks.front());
            lane.tasks.pop_front();
            lock.unlock();
            task();
            lock.lock();
        }
    }

    std::deque<Lane> lanes_;
};

}  // namespace atrium::world_server
