#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stop_token>

namespace atrium::site_node {

/// Lets the source wait until each metaframe has left the site, instead of dropping those that come
/// too early. Thread-safe.
class LockStep {
public:
    /// A metaframe is published, failed or left out.
    void finish() {
        {
            const std::lock_guard lock(mutex_);
            ++num_finished_;
        }
        changed_.notify_all();
    }

    /// Waits until `num_begun` metaframes are finished, or for a stop.
    void wait(std::uint64_t num_begun, std::stop_token stop) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, stop, [&] { return num_finished_ >= num_begun; });
    }

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::uint64_t num_finished_ = 0;
};

}  // namespace atrium::site_node
