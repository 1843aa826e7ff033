#pragma once

#include "core/bus/messages.hpp"
#include "site_node/hosts/host_event.hpp"

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace atrium::hosts {

/// A host that computes regions.
struct RegionHost {
    std::string name;
    std::vector<std::uint32_t> regions;  // indices into the regions of the site's file
};

/// Decides for which hosts of regions a metaframe waits. Uses neither network nor clock of its own.
/// Not thread-safe.
///
/// A metaframe waits for a host in use for five periods, but for a quarter of a second at least and
/// a whole one at most. Then the host is missing, or too late if it answered an older order
/// meanwhile, and nobody waits for it any more. It still gets orders. A missing host is in use
/// again with its first answer to a young order, as is one that had another rig; one that was too
/// late after ten in a row.
class RegionTable {
public:
    using Time = std::chrono::steady_clock::time_point;

    RegionTable(std::vector<RegionHost> hosts, std::chrono::nanoseconds period);

    /// An order leaves. `is_connected[host]`: DDS has found the host; one that it has just found is
    /// waited for.
    void begin(const bus::FrameKey& frame, const std::vector<bool>& is_connected, Time now);

    /// Whether the last order should leave for this host. One that does not answer gets few: what
    /// it does not take would fill the writer, which then waits.
    bool wants_order(std::size_t host) const { return hosts_[host].was_sent; }

    /// The last order did not leave for this host: nobody waits for an answer.
    void not_sent(std::size_t host) { hosts_[host].was_sent = false; }

    /// Until when the metaframe of the last order waits at most; nullopt: for nobody any more.
    std::optional<Time> waits_until(Time now) const;

    /// Takes an answer of `host` to the order of `frame`. True if that is the last one.
    bool answered(std::size_t host, const bus::FrameKey& frame, Time now);

    /// The program of this host has ended.
    void gone(std::size_t host, Time now);

    /// Takes an answer of `host` that says or shows that its rig, [hull] or regions are others.
    void refused(std::size_t host, Time now);

    /// The metaframe of the last order goes on.
    void end(Time now);

    /// Why the metaframe of the last order goes on without this host.
    std::string why_without_answer(std::size_t host) const;

    std::vector<HostEvent> take_events();
    /// A host for which the last order waits for more than half the patience counts as missing.
    /// While there are no orders, because no camera delivers, DDS decides (`is_connected`).
    std::vector<bus::HostStatus> statuses(const std::vector<bool>& is_connected, Time now) const;

private:
    struct Order {
        bus::FrameKey frame;
        Time time;
    };
    struct Host {
        bus::HostState state = bus::HostState::kMissing;
        bool is_connected = false;
        bool is_new = false;             // connected since its last answer: waited for
        bool was_sent = false;           // the last order
        bool has_answered = false;       // the last order
        std::optional<Time> last_order;  // that left
        std::optional<Time> last_answer;
        int num_in_time = 0;  // in a row
        bool was_in_use = false;
        bool was_told = false;      // of the state
        std::optional<Time> since;  // when it entered the state
        std::uint64_t num_left_out = 0;
    };

    std::optional<Time> waits_until(const Host& host) const;
    void enter(std::size_t host, bus::HostState state, Time now);
    void tell(std::size_t host, Time now);
    std::string why(const Host& host) const;

    std::vector<RegionHost> names_;
    std::chrono::nanoseconds patience_;
    bool is_slow_;  // metaframes come more seldom than a host needs to be back
    std::vector<Host> hosts_;
    std::deque<Order> orders_;  // the last ones
    Time begun_{};
    std::vector<HostEvent> events_;
};

}  // namespace atrium::hosts
