#include "site_node/capture/timed_assembler.hpp"

#include <pthread.h>

#include <utility>

namespace atrium::capture {

using Clock = std::chrono::steady_clock;

TimedAssembler::TimedAssembler(std::size_t num_cameras, const AssemblerOptions& options, Sink sink)
    : assembler_(num_cameras, options),
      sink_(std::move(sink)),
      watcher_([this](const std::stop_token& stop) { watch_deadlines(stop); }) {
    pthread_setname_np(watcher_.native_handle(), "deadlines");
}

void TimedAssembler::add(CameraFrame frame) {
    const std::lock_guard lock(mutex_);
    sink_(assembler_.add(std::move(frame), Clock::now()), assembler_);
    if (is_idle_ && assembler_.next_expiry()) opened_.notify_one();
}

void TimedAssembler::finish() {
    const std::lock_guard lock(mutex_);
    sink_(assembler_.finish(), assembler_);
}

// A later metaframe never expires before an earlier one: only an idle wait needs a notification.
void TimedAssembler::watch_deadlines(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        const auto expiry = assembler_.next_expiry();
        if (!expiry) {
            is_idle_ = true;
            opened_.wait(lock, stop, [this] { return assembler_.next_expiry().has_value(); });
            is_idle_ = false;
        } else if (Clock::now() < *expiry) {
            opened_.wait_until(lock, stop, *expiry, [] { return false; });
        } else {
            sink_(assembler_.expire(Clock::now()), assembler_);
        }
    }
}

}  // namespace atrium::capture
