#pragma once

#include "core/base/executor.hpp"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

namespace atrium {

/// Threads that a program owns and lends to its stages. The caller of `parallel_for` works too, as
/// worker 0, so a pool of n workers has n - 1 threads. One `parallel_for` at a time.
class ThreadPool final : public Executor {
public:
    /// Throws std::system_error where the system has no room for so many threads.
    explicit ThreadPool(std::size_t num_workers);
    ~ThreadPool() override;
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    std::size_t num_workers() const override { return threads_.size() + 1; }
    void parallel_for(std::size_t num_tasks, Body body) override;

private:
    void work(std::stop_token stop, std::size_t worker);
    void run_tasks(const Body& body, std::size_t num_tasks, std::size_t worker) noexcept;

    std::mutex mutex_;
    std::condition_variable_any start_;
    std::condition_variable done_;
    const Body* body_ = nullptr;  // valid while a round runs
    std::size_t num_tasks_ = 0;
    std::uint64_t round_ = 0;
    std::size_t num_busy_ = 0;    // threads that have not finished the round
    std::exception_ptr failure_;  // the round's first
    std::atomic<std::size_t> next_task_{0};
    std::vector<std::jthread> threads_;  // last: they use all of the above
};

}  // namespace atrium
