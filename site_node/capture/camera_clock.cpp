#include "site_node/capture/camera_clock.hpp"

#include <algorithm>
#include <cstdlib>

namespace atrium::capture {

Timestamp CameraClock::on_site_clock(std::uint64_t device_ns,
                                     Timestamp arrival,
                                     std::chrono::nanoseconds site_minus_raw) {
    if (device_ns == 0) return arrival;
    const std::int64_t arrival_ns = arrival.ns - site_minus_raw.count();
    const std::int64_t sample_ns = arrival_ns - static_cast<std::int64_t>(device_ns);
    const auto step = std::chrono::abs(site_minus_raw - last_site_minus_raw_);
    const bool was_set = started_ && step > kLeastStep;
    last_site_minus_raw_ = site_minus_raw;
    if (!started_ || std::abs(sample_ns - raw_minus_device_ns_) > kMaxError_ns) {
        raw_minus_device_ns_ = sample_ns;
    } else if (!was_set) {
        const auto elapsed_ns =
            static_cast<double>(std::max<std::int64_t>(arrival_ns - last_arrival_ns_, 0));
        const auto drift_ns = static_cast<std::int64_t>(kMaxDrift * elapsed_ns);
        raw_minus_device_ns_ = std::min(raw_minus_device_ns_ + drift_ns, sample_ns);
    }
    started_ = true;
    if (!was_set) last_arrival_ns_ = arrival_ns;
    return Timestamp{static_cast<std::int64_t>(device_ns) + raw_minus_device_ns_} + site_minus_raw;
}

bool BackwardsGuard::accept(std::uint64_t time_ns) {
    if (!last_ || time_ns > *last_) {
        last_ = time_ns;
        num_refused_ = 0;
        return true;
    }
    num_refused_ = num_refused_ > 0 && time_ns > last_refused_ ? num_refused_ + 1 : 1;
    last_refused_ = time_ns;
    if (num_refused_ <= kMaxRefused) return false;
    last_ = time_ns;
    num_refused_ = 0;
    return true;
}

}  // namespace atrium::capture
