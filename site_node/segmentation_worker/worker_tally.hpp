#pragma once

#include "core/app/log.hpp"
#include "core/base/statistics.hpp"

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace atrium::segmentation_worker {

/// What became of the pictures of all cameras of a program. Each picture counts once.
struct WorkerCounts {
    std::uint64_t num_answered = 0;  // its alpha is used
    std::uint64_t num_late = 0;      // no answer within the time limit, or still at work before
    std::uint64_t num_invalid = 0;   // the answer, or none was given
    std::uint64_t num_absent = 0;    // no worker, or it was not ready or went away

    std::uint64_t num_pictures() const {
        return num_answered + num_late + num_invalid + num_absent;
    }
    bool operator==(const WorkerCounts&) const = default;
};

/// Counts what a worker does for the cameras of a program, and says what is wrong with it.
/// Thread-safe.
class WorkerTally {
public:
    using Clock = std::chrono::steady_clock;

    explicit WorkerTally(double deadline_ms) : deadline_ms_(deadline_ms) {}

    void count_answered();
    void count_late();
    void count_invalid();
    void count_absent();
    /// From the offer of a picture to its answer, late ones included, which are seen at the next
    /// picture.
    void add_latency(std::chrono::nanoseconds latency);

    WorkerCounts counts() const;
    /// "answered=298 late=2 invalid=0 absent=0 median_ms=8.1 p99_ms=14.0"
    std::string line() const;

    /// Judges the last `kWindow`, and logs what is newly wrong. Leaves out the first `kWarmUp`, in
    /// which workers are slow. Call it about once a second.
    void look(Clock::time_point now);
    /// What is wrong, as a line of a status, "what: cure"; empty if nothing is.
    std::string finding() const;
    static constexpr std::chrono::seconds kWindow{10};
    static constexpr std::chrono::seconds kWarmUp{5};

    /// Log that a camera has the worker, or lost it. Cameras do so at the same time, so others are
    /// held back.
    void log_there(const std::string& line) { there_.info(line); }
    void log_missing(const std::string& line) { missing_.warn(line); }

private:
    struct Look {
        Clock::time_point time;
        WorkerCounts counts;
    };
    std::string judged(const WorkerCounts& before) const;  // under mutex_

    double deadline_ms_;
    mutable std::mutex mutex_;
    WorkerCounts counts_;
    LatencyWindow latency_;
    std::optional<Clock::time_point> first_look_;
    std::deque<Look> looks_;
    std::string finding_;
    app::log::OncePerSecond there_;
    app::log::OncePerSecond missing_;
};

}  // namespace atrium::segmentation_worker
