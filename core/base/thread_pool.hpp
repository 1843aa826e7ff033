#pragma once

#include "core/base/executor.hpp"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace atrium {

/// Runs tasks on threads that a program owns and shares among its stages. The caller of
/// `parallel_for` works too, as worker 0: a pool of n workers has n - 1 threads. One `parallel_for`
/// at a time.
///
/// `background()` is a second executor on the same threads, for one concurrent caller. Its tasks
/// start only when no task of `parallel_for` is left to start. While a `Priority` exists its caller
/// does not run tasks. Thus at most n threads run tasks, even with both in use.
class ThreadPool final : public Executor {
public:
    /// Throws std::system_error if the threads cannot be created.
    explicit ThreadPool(std::size_t num_workers);
    ~ThreadPool() override;
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    std::size_t num_workers() const override { return threads_.size() + 1; }
    void parallel_for(std::size_t num_tasks, Body body) override;

    /// Reserves one worker for a thread that calls `parallel_for`, serial parts of that thread
    /// included, until destruction. Construct it before the thread starts its work. Movable; must
    /// not outlive the pool.
    class Priority {
    public:
        Priority() = default;
        explicit Priority(ThreadPool& pool) : pool_(&pool) { pool.add_priority(1); }
        Priority(Priority&& other) noexcept : pool_(std::exchange(other.pool_, nullptr)) {}
        Priority& operator=(Priority&& other) noexcept {
            Priority old(std::move(*this));
            pool_ = std::exchange(other.pool_, nullptr);
            return *this;
        }
        ~Priority() {
            if (pool_ != nullptr) pool_->add_priority(-1);
        }

    private:
        ThreadPool* pool_ = nullptr;
    };

    /// Executor for work that must not delay `parallel_for`. Its tasks have to call `give_way`.
    Executor& background() { return background_executor_; }

private:
    // The tasks of one `parallel_for`.
    struct Round {
        const Body* body = nullptr;             // valid while the round runs
        std::atomic<std::size_t> num_tasks{0};  // also read without the lock, as a hint
        std::atomic<std::size_t> next_task{0};  // likewise
        std::size_t num_inside = 0;             // threads that may run its tasks
        std::exception_ptr failure;             // first exception of a task
        std::condition_variable changed;

        bool has_task() const {
            return next_task.load(std::memory_order_relaxed) <
                   num_tasks.load(std::memory_order_relaxed);
        }
    };

    class Background final : public Executor {
    public:
        explicit Background(ThreadPool& pool) : pool_(pool) {}
        std::size_t num_workers() const override { return pool_.num_workers(); }
        void parallel_for(std::size_t num_tasks, Body body) override {
            pool_.run_in_background(num_tasks, body);
        }
        void give_way(std::size_t worker) override { pool_.give_way(worker); }

    private:
        ThreadPool& pool_;
    };

    void stop();
    void work(std::size_t worker);
    void begin(Round& round, std::size_t num_tasks, const Body& body);
    void enter(Round& round, std::size_t worker, std::unique_lock<std::mutex>& lock);
    void run_tasks(Round& round, std::size_t worker) noexcept;
    static void finish(Round& round, std::unique_lock<std::mutex>& lock);
    bool must_leave(const Round& round, std::size_t worker) const;
    void run_in_background(std::size_t num_tasks, const Body& body);
    void give_way(std::size_t worker);
    void add_priority(int change);

    std::mutex mutex_;
    std::condition_variable start_;
    bool is_stopping_ = false;
    Round urgent_;
    Round background_;
    std::atomic<int> num_priorities_{0};
    Background background_executor_{*this};
    std::vector<std::jthread> threads_;  // last: the threads use the members above
};

}  // namespace atrium
