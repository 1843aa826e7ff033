#include "core/bus/host_messages.hpp"

#include <algorithm>

namespace atrium::bus {

bool is_texture_wanted(const SiteOrders& orders, Timestamp capture_time) {
    if (orders.send_every <= 1) return true;
    const std::int64_t period_ns = std::max<std::int64_t>(orders.period.count(), 1);
    const std::int64_t since_ns = capture_time.ns - orders.sent.ns;
    const std::int64_t half_ns = since_ns < 0 ? -(period_ns / 2) : period_ns / 2;
    return (since_ns + half_ns) / period_ns % orders.send_every == 0;
}

}  // namespace atrium::bus
