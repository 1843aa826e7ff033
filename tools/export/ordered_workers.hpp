#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

namespace atrium::exporting {

/// Runs tasks on threads of its own and gives their results in the order of the tasks. One thread
/// submits and takes. Tasks that have not begun when it is destroyed do not run.
template <typename Result>
class OrderedWorkers {
public:
    /// Called with the number of the worker: two tasks at a time have different ones.
    using Task = std::function<Result(std::size_t worker)>;

    explicit OrderedWorkers(std::size_t num_workers) {
        for (std::size_t worker = 0; worker < num_workers; ++worker)
            threads_.emplace_back(
                [this, worker](const std::stop_token& stop) { run(worker, stop); });
    }
    ~OrderedWorkers() {
        for (std::jthread& thread : threads_) thread.request_stop();
        threads_.clear();  // before what they use
    }
    OrderedWorkers(const OrderedWorkers&) = delete;
    OrderedWorkers& operator=(const OrderedWorkers&) = delete;

    void submit(Task task) {
        std::packaged_task<Result(std::size_t)> packaged(std::move(task));
        results_.push_back(packaged.get_future());
        {
            const std::lock_guard lock(mutex_);
            tasks_.push_back(std::move(packaged));
        }
        changed_.notify_one();
    }
    /// Tasks whose results were not taken.
    std::size_t num_open() const { return results_.size(); }
    /// Waits for the oldest task and returns its result, or throws its exception. There must be
    /// one.
    Result take() {
        std::future<Result> first = std::move(results_.front());
        results_.pop_front();
        return first.get();
    }

private:
    void run(std::size_t worker, const std::stop_token& stop) {
        for (;;) {
            std::packaged_task<Result(std::size_t)> task;
            {
                std::unique_lock lock(mutex_);
                if (!changed_.wait(lock, stop, [&] { return !tasks_.empty(); }) ||
                    stop.stop_requested())
                    return;
                task = std::move(tasks_.front());
                tasks_.pop_front();
            }
            task(worker);
        }
    }

    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<std::packaged_task<Result(std::size_t)>> tasks_;
    std::deque<std::future<Result>> results_;  // of the caller's thread only
    std::vector<std::jthread> threads_;
};

}  // namespace atrium::exporting
