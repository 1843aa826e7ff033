#pragma once

#include "core/base/timestamp.hpp"
#include "core/bus/messages.hpp"
#include "site_node/capture/metaframe.hpp"
#include "site_node/hosts/host_clock.hpp"
#include "site_node/hosts/host_event.hpp"
#include "site_node/hosts/site_hosts.hpp"

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace atrium::hosts {

struct HostTableOptions {
    std::chrono::nanoseconds period{};    // between two instants of the site
    std::chrono::nanoseconds deadline{};  // how long a metaframe waits for pictures
    /// Per host, as handed to the table: its part_fingerprint. Empty: 0 for all.
    std::vector<std::uint64_t> parts{};
};

/// Decides which camera nodes' silhouettes become part of metaframes, and when they were captured
/// on this host's clock. Uses neither network nor clock of its own. Not thread-safe.
///
/// A silhouette counts only while the clock of its host is known to an eighth of a period and is
/// off by at most a quarter; its time is then corrected. So two pictures of different instants are
/// never closer than half a period, and the assembler cannot mix them. Of each other host, lost
/// pictures are reported in its place: nobody waits for it.
///
/// A camera that no host names belongs to the host with `cameras = "auto"`; of several such hosts
/// to that which sends pictures of it, and to another one if these end.
class HostTable {
public:
    using Time = std::chrono::steady_clock::time_point;

    HostTable(std::vector<std::string> cameras,
              const std::vector<HostEntry>& hosts,
              const HostTableOptions& options);

    /// Takes a silhouette that arrived at `now` on this host's clock. Appends the frames that it
    /// yields.
    void add(bus::CameraSilhouette silhouette,
             Timestamp now,
             Time arrival,
             std::vector<capture::CameraFrame>& out);

    void add(const bus::ClockAnswer& answer, Timestamp returned, Time arrival);

    /// This host's own clock was set: nothing is known of the others. None is in use before the
    /// metaframes that wait for pictures by the former clock are gone.
    void forget_clocks(Time now);

    /// Whether the camera, an index into the rig, hangs on that host.
    bool has_camera(const std::string& host, std::size_t camera) const;

    /// Decides anew which hosts are in use. Call it several times a second.
    void look(Time now);

    /// Lines for the log since the last call.
    std::vector<HostEvent> take_events();

    std::vector<bus::HostStatus> statuses() const;
    bool is_in_use(std::size_t camera) const;

private:
    struct Host {
        HostEntry entry;
        std::map<std::uint64_t, HostClock> clocks;  // per epoch of its clock
        std::uint64_t epoch = 0;                    // of its last silhouette
        std::uint64_t part = 0;                     // its part_fingerprint
        bool has_our_part = true;                   // by its last silhouette
        std::optional<Time> last_heard;
        bool has_grace = false;                       // since it was heard
        std::deque<std::chrono::nanoseconds> delays;  // of the last pictures
        HostClock::Estimate clock;                    // if it has one
        bus::HostState state = bus::HostState::kMissing;
        std::optional<Time> since;  // when it entered the state
        bool was_told = false;      // of the state
        bool was_in_use = false;
        std::uint64_t num_left_out = 0;
    };

    Host* owner_of(const bus::CameraSilhouette& silhouette, Time now);
    Host* claim(const bus::CameraSilhouette& silhouette, Time now);
    std::chrono::nanoseconds silence() const;
    bus::HostState judge(Host& host, Time now) const;
    void give_grace(Time now);
    void enter(Host& host, bus::HostState state, Time now);
    void tell(Host& host, Time now);
    std::string why(const Host& host) const;
    std::string names_of_cameras(const Host& host) const;

    std::vector<std::string> cameras_;
    HostTableOptions options_;
    std::vector<Host> hosts_;
    std::vector<std::optional<std::size_t>> owners_;  // per camera; empty: none has it
    std::vector<bool> is_open_;        // per camera: belongs to whichever auto host sends it
    std::vector<Time> last_pictures_;  // per camera
    std::vector<HostEvent> events_;
    std::set<std::pair<std::string, std::uint32_t>> strangers_;  // that were named
    std::optional<Time> forgotten_;                              // when the own clock was set
    std::optional<Time> last_look_;
};

}  // namespace atrium::hosts
