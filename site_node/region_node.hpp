#pragma once

#include "core/app/log.hpp"
#include "core/base/expected.hpp"
#include "core/base/processor_use.hpp"
#include "core/base/statistics.hpp"
#include "core/base/thread_pool.hpp"
#include "core/bus/bus.hpp"
#include "core/presence/membership.hpp"
#include "site_node/config.hpp"
#include "site_node/region_work.hpp"
#include "site_node/run_control.hpp"

#include <cstdint>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>

namespace atrium::site_node {

/// Whether this host computes regions for the model part on another host.
bool is_region_host(const SiteNodeConfig& config);

/// The hulls of some regions of a site: gets silhouettes from the model part and answers with
/// meshes. The newest order wins. `create` does everything that can fail; `run` owns the threads.
class RegionNode {
public:
    static Expected<std::unique_ptr<RegionNode>> create(const SiteNodeConfig& config,
                                                        std::stop_token stop);

    /// Runs until the stop or `site.seconds`. One caller at a time.
    Expected<void> run(std::stop_token stop);

    /// Thread-safe.
    bus::RegionNodeStatus status() const;

private:
    struct Bus {
        bus::Reader<bus::RegionOrder> orders;
        bus::Writer<bus::RegionMeshes> meshes;
        bus::Writer<bus::RegionNodeStatus> status;
        bus::Waiter waiter;
    };

    RegionNode(SiteNodeConfig config,
               std::string host,
               RegionWork work,
               Bus bus,
               std::shared_ptr<RunControl> run_control,
               std::unique_ptr<presence::Membership> membership);

    void follow_orders(std::stop_token stop);
    void answer(const bus::RegionOrder& order);
    void report_status(std::stop_token stop);

    SiteNodeConfig config_;
    std::string host_;
    RegionWork work_;
    Bus bus_;
    ThreadPool pool_;
    std::uint64_t last_number_ = 0;  // of an order; 0: none yet
    bus::RegionMeshes answer_;       // keeps its memory

    mutable std::mutex mutex_;  // guards the members below
    bus::RegionNodeStatus status_;
    LatencyWindow order_to_mesh_;
    LatencyWindow hull_;
    LatencyWindow coding_;
    LatencyWindow publishing_;
    ProcessorMeter processor_meter_;  // of the reporting thread
    app::log::OncePerSecond complaints_;

    std::shared_ptr<RunControl> run_control_;  // shared with the membership
    std::unique_ptr<presence::Membership> membership_;
};

}  // namespace atrium::site_node
