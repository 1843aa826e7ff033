#include "core/base/thread_pool.hpp"

#include <utility>

namespace atrium {

ThreadPool::ThreadPool(std::size_t num_workers) {
    for (std::size_t worker = 1; worker < num_workers; ++worker) {
        threads_.emplace_back(
            [this, worker](std::stop_token stop) { work(std::move(stop), worker); });
    }
}

ThreadPool::~ThreadPool() {
    for (std::jthread& thread : threads_) thread.request_stop();
}

void ThreadPool::parallel_for(std::size_t num_tasks, Body body) {
    if (threads_.empty() || num_tasks < 2) {
        for (std::size_t task = 0; task < num_tasks; ++task) body(task, 0);
        return;
    }
    {
        const std::lock_guard lock(mutex_);
        body_ = &body;
        num_tasks_ = num_tasks;
        next_task_.store(0, std::memory_order_relaxed);
        num_busy_ = threads_.size();
        ++round_;
    }
    start_.notify_all();
    run_tasks(body, num_tasks, 0);
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return num_busy_ == 0; });
    body_ = nullptr;
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ThreadPool::work(std::stop_token stop, std::size_t worker) {
    std::uint64_t seen = 0;
    for (;;) {
        std::unique_lock lock(mutex_);
        if (!start_.wait(lock, stop, [&] { return round_ != seen; })) return;
        seen = round_;
        const Body body = *body_;
        const std::size_t num_tasks = num_tasks_;
        lock.unlock();
        run_tasks(body, num_tasks, worker);
        lock.lock();
        if (--num_busy_ == 0) done_.notify_one();
    }
}

void ThreadPool::run_tasks(const Body& body, std::size_t num_tasks, std::size_t worker) noexcept {
    try {
        for (;;) {
            const std::size_t task = next_task_.fetch_add(1, std::memory_order_relaxed);
            if (task >= num_tasks) return;
            body(task, worker);
        }
    } catch (...) {
        next_task_.store(num_tasks, std::memory_order_relaxed);  // the others need not go on
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = std::current_exception();
    }
}

}  // namespace atrium
