#include "site_node/hosts/region_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace atrium::hosts {
namespace {

using std::chrono::nanoseconds;

constexpr nanoseconds kLeastPatience = std::chrono::milliseconds(250);
constexpr nanoseconds kMostPatience = std::chrono::seconds(1);
constexpr nanoseconds kLongestRegionStart = std::chrono::seconds(3);
constexpr std::size_t kRememberedOrders = 64;
constexpr int kInTime = 10;  // answers in a row until a late host is waited for again

}  // namespace

RegionTable::RegionTable(std::vector<RegionHost> hosts, nanoseconds period)
    : names_(std::move(hosts)),
      patience_(std::clamp(5 * period, kLeastPatience, kMostPatience)),
      is_slow_(period > kLeastPatience),
      hosts_(names_.size()) {}

void RegionTable::begin(const bus::FrameKey& frame,
                        const std::vector<bool>& is_connected,
                        Time now) {
    begun_ = now;
    orders_.push_back({frame, now});
    if (orders_.size() > kRememberedOrders) orders_.pop_front();
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
        Host& host = hosts_[i];
        host.has_answered = false;
        if (is_connected[i] && !host.is_connected) host.is_new = true;
        host.is_connected = is_connected[i];
        if (!host.is_connected) enter(i, bus::HostState::kMissing, now);
        const bool is_silent = host.state == bus::HostState::kMissing && !host.is_new;
        host.was_sent = host.is_connected &&
                        !(is_silent && host.last_order && now - *host.last_order < kLeastPatience);
        if (host.was_sent) host.last_order = now;
    }
}

std::optional<RegionTable::Time> RegionTable::waits_until(const Host& host) const {
    if (!host.is_connected || !host.was_sent || host.has_answered) return std::nullopt;
    if (host.state == bus::HostState::kInUse || host.is_new) return begun_ + patience_;
    // its answer would be too old when the next metaframe looks for it
    if (host.state == bus::HostState::kMissing && is_slow_) return begun_ + kLeastPatience;
    return std::nullopt;
}

std::optional<RegionTable::Time> RegionTable::waits_until(Time now) const {
    std::optional<Time> last;
    for (const Host& host : hosts_) {
        const auto until = waits_until(host);
        if (until && *until > now) last = std::max(last.value_or(*until), *until);
    }
    return last;
}

void RegionTable::gone(std::size_t i, Time now) {
    hosts_[i].is_new = false;
    hosts_[i].was_sent = false;
    enter(i, bus::HostState::kMissing, now);
}

bool RegionTable::answered(std::size_t i, const bus::FrameKey& frame, Time now) {
    const auto order = std::ranges::find(orders_, frame, &Order::frame);
    if (order == orders_.end()) return false;
    Host& host = hosts_[i];
    const bool is_last = order->frame == orders_.back().frame;
    const bool is_young = now - order->time <= patience_ / 2;
    host.last_answer = now;
    host.has_answered |= is_last;
    host.num_in_time = is_young ? host.num_in_time + 1 : 0;
    const bool is_enough =
        host.state == bus::HostState::kLate ? host.num_in_time >= kInTime : is_young || host.is_new;
    if (host.state != bus::HostState::kInUse && is_enough)
        enter(i, bus::HostState::kInUse, now);
    else if (host.state == bus::HostState::kMissing)
        enter(i, bus::HostState::kLate, now);
    host.is_new = false;
    return is_last;
}

void RegionTable::refused(std::size_t i, Time now) {
    hosts_[i].last_answer = now;
    hosts_[i].is_new = false;
    enter(i, bus::HostState::kOtherRig, now);
}

void RegionTable::end(Time now) {
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
        Host& host = hosts_[i];
        if (waits_until(host)) {
            // patience is over
            const bool is_alive = host.last_answer && *host.last_answer >= begun_;
            enter(i, is_alive ? bus::HostState::kLate : bus::HostState::kMissing, now);
            host.is_new = false;
            host.num_in_time = 0;
        }
        if (!host.has_answered) ++host.num_left_out;
        tell(i, now);
    }
}

void RegionTable::enter(std::size_t i, bus::HostState state, Time now) {
    Host& host = hosts_[i];
    if (host.state != state || !host.since) {
        host.state = state;
        host.since = now;
        host.was_told = false;
    }
    tell(i, now);
}

// Tells of a state once. At the start a host may be missing for a while.
void RegionTable::tell(std::size_t i, Time now) {
    Host& host = hosts_[i];
    if (host.was_told || !host.since) return;
    const bool is_start = host.state == bus::HostState::kMissing && !host.was_in_use;
    if (is_start && now - *host.since < kLongestRegionStart) return;
    host.was_told = true;
    const std::string& name = names_[i].name;
    if (host.state == bus::HostState::kInUse) {
        host.was_in_use = true;
        events_.push_back(
            {false, fmt::format("host_in_use host={} regions={}", name, names_[i].regions.size())});
        return;
    }
    events_.push_back(
        {true,
         fmt::format(
             "host_left_out host={} regions={} {}", name, names_[i].regions.size(), why(host))});
}

std::string RegionTable::why_without_answer(std::size_t i) const {
    switch (hosts_[i].state) {
        case bus::HostState::kLate:
            return "its meshes come too late";
        case bus::HostState::kOtherRig:
            return "its rig, [hull] or regions differ from this host's";
        case bus::HostState::kMissing:
            return "nothing comes from it";
        default:
            return "it did not answer";
    }
}

std::string RegionTable::why(const Host& host) const {
    switch (host.state) {
        case bus::HostState::kLate:
            return fmt::format(
                "reason=\"its meshes came more than {:.0f} ms after their silhouettes; it is back "
                "when "
                "ten in a row need less than half of that\" "
                "advice=\"give it fewer regions or more cores: atrium plan; atrium doctor on that "
                "host\"",
                milliseconds(patience_));
        case bus::HostState::kOtherRig:
            return "reason=\"its rig, [hull] or regions differ from this host's\" advice=\"copy "
                   "the "
                   "site's file and its rig to all hosts, and start site_node there anew\"";
        default:
            return "reason=\"nothing comes from it\" advice=\"is site_node running there? is the "
                   "network up?\"";
    }
}

std::vector<HostEvent> RegionTable::take_events() { return std::exchange(events_, {}); }

std::vector<bus::HostStatus> RegionTable::statuses(const std::vector<bool>& is_connected,
                                                   Time now) const {
    const bool is_idle = orders_.empty() || now - begun_ > 2 * patience_;
    std::vector<bus::HostStatus> statuses;
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
        bus::HostStatus status;
        status.name = names_[i].name;
        const bool is_overdue = waits_until(hosts_[i]) && now - begun_ > patience_ / 2;
        status.state = is_overdue ? bus::HostState::kMissing : hosts_[i].state;
        // of one that DDS found since the last order nothing is known but that it is there
        const bool is_found = is_connected[i] && !hosts_[i].is_connected;
        if (is_idle && !is_connected[i]) status.state = bus::HostState::kMissing;
        if (is_idle && is_found) status.state = bus::HostState::kInUse;
        status.num_regions = static_cast<std::uint32_t>(names_[i].regions.size());
        status.num_left_out = hosts_[i].num_left_out;
        statuses.push_back(std::move(status));
    }
    return statuses;
}

}  // namespace atrium::hosts
