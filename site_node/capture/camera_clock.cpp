#include "site_node/capture/camera_clock.hpp"

#include <algorithm>
#include <cstdlib>

namespace atrium::capture {

Timestamp CameraClock::on_site_clock(std::uint64_t device_ns, Timestamp arrival) {
    if (device_ns == 0) return arrival;
    const std::int64_t sample_ns = arrival.ns - static_cast<std::int64_t>(device_ns);
    const bool is_new = !started_ || std::abs(sample_ns - site_minus_device_ns_) > kMaxError_ns;
    if (is_new) {
        site_minus_device_ns_ = sample_ns;
    } else {
        const auto elapsed_ns =
            static_cast<double>(std::max<std::int64_t>((arrival - last_arrival_).count(), 0));
        const auto drift_ns = static_cast<std::int64_t>(kMaxDrift * elapsed_ns);
        site_minus_device_ns_ = std::min(site_minus_device_ns_ + drift_ns, sample_ns);
    }
    started_ = true;
    last_arrival_ = arrival;
    return {static_cast<std::int64_t>(device_ns) + site_minus_device_ns_};
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
