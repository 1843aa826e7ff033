#pragma once

#include "core/app/lasting_log.hpp"
#include "core/app/log.hpp"
#include "core/bus/bus.hpp"
#include "core/bus/messages.hpp"
#include "site_node/hosts/region_table.hpp"
#include "site_node/hosts/remote_regions.hpp"

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace atrium::hosts {

/// The part of a site's world in which a host of regions gets its orders.
std::string order_part(const std::string& site, const std::string& host);

struct RegionHostsOptions {
    std::string site;
    std::vector<RegionHost> hosts;
    /// Per region the cameras that watch it, indices into the rig.
    std::vector<std::vector<std::uint32_t>> cameras;
    std::chrono::nanoseconds period{};  // between two instants of the site
    std::uint64_t settings = 0;         // as in bus::RegionOrder
};

/// Hands the silhouettes of each metaframe to the hosts that compute regions, and collects their
/// meshes. `order` and `collect` belong to one thread.
class RegionHosts final : public RemoteRegions {
public:
    static Expected<std::unique_ptr<RegionHosts>> open(const bus::Participant& participant,
                                                       RegionHostsOptions options);

    void order(const bus::FrameKey& frame,
               std::span<const hull::SilhouetteView> views,
               std::span<const std::uint8_t> delivered) override;
    std::vector<bus::RegionMeshes> collect() override;

    /// Thread-safe.
    std::vector<bus::HostStatus> statuses() const;

private:
    struct Bus {
        std::vector<bus::Writer<bus::RegionOrder>> orders;  // per host
        bus::Reader<bus::RegionMeshes> meshes;
        bus::Waiter waiter;
    };

    RegionHosts(RegionHostsOptions options, Bus bus);
    void take_answers(std::vector<std::optional<bus::RegionMeshes>>& answers);
    bool wants_order(std::size_t host) const;
    bool is_ours(const bus::RegionMeshes& answer, const RegionHost& host) const;
    bus::RegionMeshes without_answer(std::size_t host) const;

    RegionHostsOptions options_;
    Bus bus_;
    std::vector<std::vector<std::uint32_t>> cameras_;  // per host
    bus::FrameKey frame_;                              // of the last order
    std::vector<std::uint64_t> num_orders_;            // per host: that left
    std::vector<std::string> failures_;                // per host: why its last order did not leave
    mutable std::mutex mutex_;                         // guards `table_`
    RegionTable table_;
    app::log::OncePerSecond complaints_;
    app::log::LastingLog failed_;
};

}  // namespace atrium::hosts
