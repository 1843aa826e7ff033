#include "core/base/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace atrium {

LatencyWindow::LatencyWindow(std::size_t capacity) : capacity_(std::max<std::size_t>(capacity, 1)) {
    ring_ms_.reserve(capacity_);
}

void LatencyWindow::add(std::chrono::nanoseconds duration) {
    const double ms = std::chrono::duration<double, std::milli>(duration).count();
    if (ring_ms_.size() < capacity_) {
        ring_ms_.push_back(ms);
    } else {
        ring_ms_[next_] = ms;
    }
    next_ = (next_ + 1) % capacity_;
}

Quantiles LatencyWindow::quantiles() const {
    if (ring_ms_.empty()) return {};
    std::vector<double> sorted = ring_ms_;
    std::sort(sorted.begin(), sorted.end());
    // nearest rank: the smallest value that at least the given share does not exceed
    const auto at = [&](double share) {
        const double rank = std::ceil(share * static_cast<double>(sorted.size()));
        return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
    };
    return {at(0.5), at(0.99), sorted.size()};
}

double RateMeter::update(std::uint64_t total, std::chrono::steady_clock::time_point now) {
    double rate = 0.0;
    if (started_) {
        const double elapsed_s = std::chrono::duration<double>(now - last_time_).count();
        if (elapsed_s > 0.0) rate = static_cast<double>(total - last_total_) / elapsed_s;
    }
    started_ = true;
    last_total_ = total;
    last_time_ = now;
    return rate;
}

}  // namespace atrium
