#pragma once

#include <pthread.h>

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace atrium {

/// Handles the newest value of each key on a small pool of threads.
///
/// Values of one key are handled in the order of their `put`, one at a time. A newer value replaces
/// a waiting one of its key. Keys are served in the order in which they began to wait, thus a busy
/// key cannot starve another. Threads are started on demand, up to the limit: one key uses one
/// thread at any rate of values. Thread-safe except `stop` and the destructor; handlers may call
/// `put`.
template <typename Value>
class KeyedWorkers {
public:
    /// Handles one value. `worker` is less than max_threads() and differs between concurrent
    /// handlers: an index for scratch memory. Must not throw.
    using Handle = std::function<void(const std::string& key, Value value, std::size_t worker)>;

    /// `name` is the name of the threads, at most 15 bytes. `max_threads` 0 means 1.
    KeyedWorkers(std::string name, std::size_t max_threads, Handle handle)
        : name_(std::move(name)),
          max_threads_(std::max<std::size_t>(1, max_threads)),
          handle_(std::move(handle)) {}
    ~KeyedWorkers() { stop(); }
    KeyedWorkers(const KeyedWorkers&) = delete;
    KeyedWorkers& operator=(const KeyedWorkers&) = delete;

    /// Queues a value without waiting for a handler. Returns the value that will not be handled, if
    /// any: the replaced one or, after `stop`, `value` itself. Throws std::system_error if not even
    /// one thread can be started.
    std::optional<Value> put(const std::string& key, Value value) {
        std::optional<Value> replaced;
        {
            const std::lock_guard lock(mutex_);
            if (is_stopped_) return value;
            Entry& entry = entries_[key];
            replaced = std::exchange(entry.waiting, std::move(value));
            if (replaced || entry.is_busy) return replaced;
            ready_.push_back(key);
            if (num_idle_ < ready_.size() && threads_.size() < max_threads_) start_thread();
        }
        changed_.notify_one();
        return replaced;
    }

    /// Waits for the running handlers and ends the threads. Drops the waiting values. Do not call
    /// it from a handler.
    void stop() {
        std::vector<std::jthread> threads;
        {
            const std::lock_guard lock(mutex_);
            is_stopped_ = true;
            threads.swap(threads_);
        }
        for (std::jthread& thread : threads) thread.request_stop();
        threads.clear();  // joins
        const std::lock_guard lock(mutex_);
        entries_.clear();
        ready_.clear();
    }

    /// Blocks until no value waits and no handler runs.
    void wait_until_idle() {
        std::unique_lock lock(mutex_);
        idle_.wait(lock, [this] { return entries_.empty(); });
    }

    std::size_t num_threads() const {
        const std::lock_guard lock(mutex_);
        return threads_.size();
    }
    std::size_t max_threads() const { return max_threads_; }

private:
    struct Entry {
        std::optional<Value> waiting;
        bool is_busy = false;  // a handler has a value of the key
    };

    void start_thread() {
        const std::size_t worker = threads_.size();
        try {
            threads_.emplace_back(
                [this, worker](std::stop_token stop) { work(std::move(stop), worker); });
        } catch (const std::system_error&) {
            if (threads_.empty()) throw;
            return;  // the existing threads serve all keys
        }
        pthread_setname_np(threads_.back().native_handle(), name_.c_str());
    }

    void work(std::stop_token stop, std::size_t worker) {
        std::unique_lock lock(mutex_);
        for (;;) {
            ++num_idle_;
            const bool has_work = changed_.wait(lock, stop, [this] { return !ready_.empty(); });
            --num_idle_;
            if (!has_work || stop.stop_requested()) return;
            // stays valid: only the thread that handles a key erases its entry
            const auto entry = entries_.find(ready_.front());
            ready_.pop_front();
            std::optional<Value> value = std::exchange(entry->second.waiting, std::nullopt);
            entry->second.is_busy = true;
            lock.unlock();
            handle_(entry->first, std::move(*value), worker);
            value.reset();
            lock.lock();
            entry->second.is_busy = false;
            if (entry->second.waiting)
                ready_.push_back(entry->first);
            else
                entries_.erase(entry);
            if (entries_.empty()) idle_.notify_all();
        }
    }

    const std::string name_;
    const std::size_t max_threads_;
    const Handle handle_;
    mutable std::mutex mutex_;  // guards the members below
    std::condition_variable_any changed_;
    std::condition_variable idle_;          // no entries
    std::map<std::string, Entry> entries_;  // keys that wait or are busy
    std::deque<std::string> ready_;         // keys that wait and are not busy, oldest first
    std::size_t num_idle_ = 0;              // threads that wait for a key
    bool is_stopped_ = false;
    std::vector<std::jthread> threads_;
};

}  // namespace atrium
