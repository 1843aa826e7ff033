#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium {

struct Quantiles {
    double median_ms = 0.0;
    double p99_ms = 0.0;
    std::size_t num_samples = 0;  // 0: nothing was measured; the other two are invalid
};

/// Keeps the durations of the last `capacity` events. Only the constructor and `quantiles` allocate
/// memory. Not thread-safe.
class LatencyWindow {
public:
    explicit LatencyWindow(std::size_t capacity = 512);
    void add(std::chrono::nanoseconds duration);
    Quantiles quantiles() const;

private:
    std::vector<double> ring_ms_;
    std::size_t capacity_;
    std::size_t next_ = 0;
};

/// Converts a running count to a rate: events per second between two calls.
class RateMeter {
public:
    /// Returns the mean rate since the last call; 0 on the first. `total` is the running count.
    double update(std::uint64_t total, std::chrono::steady_clock::time_point now);

private:
    std::uint64_t last_total_ = 0;
    std::chrono::steady_clock::time_point last_time_{};
    bool started_ = false;
};

}  // namespace atrium
