#include "site_node/segmentation_worker/worker_tally.hpp"

#include <fmt/format.h>

namespace atrium::segmentation_worker {
namespace {

// Less is a hiccup: one of twenty pictures.
constexpr double kTooMany = 0.05;
constexpr std::uint64_t kFewPictures = 20;

}  // namespace

void WorkerTally::count_answered() {
    const std::lock_guard lock(mutex_);
    ++counts_.num_answered;
}

void WorkerTally::count_late() {
    const std::lock_guard lock(mutex_);
    ++counts_.num_late;
}

void WorkerTally::count_invalid() {
    const std::lock_guard lock(mutex_);
    ++counts_.num_invalid;
}

void WorkerTally::count_absent() {
    const std::lock_guard lock(mutex_);
    ++counts_.num_absent;
}

void WorkerTally::add_latency(std::chrono::nanoseconds latency) {
    const std::lock_guard lock(mutex_);
    latency_.add(latency);
}

WorkerCounts WorkerTally::counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
}

std::string WorkerTally::line() const {
    const std::lock_guard lock(mutex_);
    std::string line = fmt::format("answered={} late={} invalid={} absent={}",
                                   counts_.num_answered,
                                   counts_.num_late,
                                   counts_.num_invalid,
                                   counts_.num_absent);
    const Quantiles latency = latency_.quantiles();
    if (latency.num_samples > 0)
        line += fmt::format(" median_ms={:.1f} p99_ms={:.1f}", latency.median_ms, latency.p99_ms);
    return line;
}

void WorkerTally::look(Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    if (!first_look_) first_look_ = now;
    if (now - *first_look_ < kWarmUp) return;
    while (looks_.size() > 1 && looks_[1].time <= now - kWindow) looks_.pop_front();
    looks_.push_back({now, counts_});
    const bool was_fine = finding_.empty();
    finding_ = judged(looks_.front().counts);
    if (was_fine && !finding_.empty())
        app::log::warn("segmentation_worker_fails reason=\"{}\"", finding_);
}

std::string WorkerTally::finding() const {
    const std::lock_guard lock(mutex_);
    return finding_;
}

std::string WorkerTally::judged(const WorkerCounts& before) const {
    const std::uint64_t num = counts_.num_pictures() - before.num_pictures();
    if (num < kFewPictures) return {};
    const auto share = [&](std::uint64_t WorkerCounts::*count) {
        return static_cast<double>(counts_.*count - before.*count) / static_cast<double>(num);
    };
    const double absent = share(&WorkerCounts::num_absent);
    const double invalid = share(&WorkerCounts::num_invalid);
    const double late = share(&WorkerCounts::num_late);
    if (absent >= kTooMany)
        return fmt::format(
            "no segmentation worker for {:.0f} % of the pictures: start it "
            "(docs/segmentation_worker.md)",
            100.0 * absent);
    if (invalid >= kTooMany)
        return fmt::format(
            "the segmentation worker gives no valid answer for {:.0f} % of the "
            "pictures: see its output and the site's log",
            100.0 * invalid);
    if (late < kTooMany) return {};
    return fmt::format(
        "the segmentation worker is late for {:.0f} % of the pictures (median "
        "{:.0f} ms, limit {:g} ms): make it faster, or raise "
        "segmentation.worker_deadline_ms",
        100.0 * late,
        latency_.quantiles().median_ms,
        deadline_ms_);
}

}  // namespace atrium::segmentation_worker
