#include "core/base/thread_pool.hpp"

#include <utility>

namespace atrium {

ThreadPool::ThreadPool(std::size_t num_workers) {
    try {
        for (std::size_t worker = 1; worker < num_workers; ++worker)
            threads_.emplace_back([this, worker] { work(worker); });
    } catch (...) {
        stop();
        throw;
    }
}

ThreadPool::~ThreadPool() { stop(); }

void ThreadPool::stop() {
    {
        const std::lock_guard lock(mutex_);
        is_stopping_ = true;
    }
    start_.notify_all();
    threads_.clear();  // joins
}

void ThreadPool::begin(Round& round, std::size_t num_tasks, const Body& body) {
    {
        const std::lock_guard lock(mutex_);
        round.body = &body;
        round.next_task.store(0, std::memory_order_relaxed);
        round.num_tasks.store(num_tasks, std::memory_order_relaxed);
    }
    start_.notify_all();
}

// Runs tasks of `round`. Releases the lock meanwhile.
void ThreadPool::enter(Round& round, std::size_t worker, std::unique_lock<std::mutex>& lock) {
    ++round.num_inside;
    lock.unlock();
    run_tasks(round, worker);
    lock.lock();
    if (--round.num_inside == 0 && !round.has_task()) round.changed.notify_all();
}

// Waits until the other threads have left `round`, then rethrows its failure.
void ThreadPool::finish(Round& round, std::unique_lock<std::mutex>& lock) {
    round.changed.wait(lock, [&] { return round.num_inside == 0 && !round.has_task(); });
    round.body = nullptr;
    if (round.failure) {
        const std::exception_ptr failure = std::exchange(round.failure, nullptr);
        lock.unlock();
        std::rethrow_exception(failure);
    }
}

void ThreadPool::parallel_for(std::size_t num_tasks, Body body) {
    if (threads_.empty() || num_tasks < 2) {
        for (std::size_t task = 0; task < num_tasks; ++task) body(task, 0);
        return;
    }
    begin(urgent_, num_tasks, body);
    std::unique_lock lock(mutex_);
    enter(urgent_, 0, lock);
    finish(urgent_, lock);
}

void ThreadPool::run_in_background(std::size_t num_tasks, const Body& body) {
    if (num_tasks == 0) return;
    begin(background_, num_tasks, body);
    std::unique_lock lock(mutex_);
    while (background_.has_task()) {
        if (num_priorities_ == 0) {
            enter(background_, 0, lock);
        } else {
            background_.changed.wait(
                lock, [this] { return num_priorities_ == 0 || !background_.has_task(); });
        }
    }
    finish(background_, lock);
}

void ThreadPool::give_way(std::size_t worker) {
    if (worker == 0) {
        if (num_priorities_.load(std::memory_order_relaxed) == 0) return;
        std::unique_lock lock(mutex_);
        background_.changed.wait(lock, [this] { return num_priorities_ == 0; });
        return;
    }
    if (!urgent_.has_task()) return;
    std::unique_lock lock(mutex_);
    if (urgent_.has_task()) enter(urgent_, worker, lock);
}

void ThreadPool::add_priority(int change) {
    const std::lock_guard lock(mutex_);
    num_priorities_ += change;
    if (num_priorities_ == 0) background_.changed.notify_all();
}

void ThreadPool::work(std::size_t worker) {
    std::unique_lock lock(mutex_);
    for (;;) {
        // Looks at each round once: its last task may be taken at any time. Who enters a round
        // without a task may still be inside when the next one begins.
        Round* round = nullptr;
        start_.wait(lock, [&] {
            if (urgent_.has_task())
                round = &urgent_;
            else if (background_.has_task())
                round = &background_;
            return is_stopping_ || round != nullptr;
        });
        if (is_stopping_) return;
        enter(*round, worker, lock);
    }
}

// True if `worker` has to leave `round` between two tasks, in favour of more urgent work.
bool ThreadPool::must_leave(const Round& round, std::size_t worker) const {
    if (&round == &urgent_) return false;
    return worker == 0 ? num_priorities_.load(std::memory_order_relaxed) > 0 : urgent_.has_task();
}

void ThreadPool::run_tasks(Round& round, std::size_t worker) noexcept {
    const std::size_t num_tasks = round.num_tasks.load(std::memory_order_relaxed);
    try {
        while (!must_leave(round, worker)) {
            const std::size_t task = round.next_task.fetch_add(1, std::memory_order_relaxed);
            if (task >= num_tasks) return;
            (*round.body)(task, worker);
        }
    } catch (...) {
        round.next_task.store(num_tasks, std::memory_order_relaxed);  // skip the remaining tasks
        const std::lock_guard lock(mutex_);
        if (!round.failure) round.failure = std::current_exception();
    }
}

}  // namespace atrium
