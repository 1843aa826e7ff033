#include "site_node/region_node.hpp"

#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/base/named_thread.hpp"
#include "core/base/next_second.hpp"
#include "core/bus/names.hpp"
#include "core/presence/join_world.hpp"
#include "core/status/bottleneck.hpp"
#include "site_node/hosts/model_part_watch.hpp"
#include "site_node/hosts/region_hosts.hpp"
#include "site_node/start_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <optional>
#include <thread>
#include <tuple>
#include <utility>

namespace atrium::site_node {
namespace {

using Clock = std::chrono::steady_clock;

bus::LatencySummary summary(const LatencyWindow& window) {
    const Quantiles q = window.quantiles();
    return {q.median_ms, q.p99_ms, q.num_samples};
}

// The regions of this host, with the cameras of the whole site.
Expected<RegionWork> own_work(SiteNodeConfig config, const hosts::HostEntry& own) {
    const auto rig = load_checked_description(config);
    if (!rig) return tl::unexpected(rig.error());
    HullStageOptions& options = config.pipeline.hull;
    take_bounds(*rig, options);
    for (RegionOptions& region : options.regions)
        region.is_elsewhere = std::ranges::find(own.regions, region.name) == own.regions.end();
    auto hull = HullStage::create(rig->cameras, options, config.pipeline.silhouette.tolerance_px);
    if (!hull) return tl::unexpected(hull.error());
    return RegionWork(
        rig->cameras, std::move(*hull), config.pipeline.mesh, hull_settings(config, *rig));
}

}  // namespace

bool is_region_host(const SiteNodeConfig& config) {
    if (config.hosts.empty()) return false;
    const auto own = hosts::find_host(config.hosts, own_host(config));
    return own && !own->is_model && !own->regions.empty();
}

Expected<std::unique_ptr<RegionNode>> RegionNode::create(const SiteNodeConfig& asked,
                                                         std::stop_token stop) {
    SiteNodeConfig config = asked;
    if (config.threads == 0) config.threads = default_threads();
    const auto own = hosts::find_host(config.hosts, own_host(config));
    if (!own) return tl::unexpected(own.error());
    if (!config.preview.empty())
        return make_error(ErrorKind::kConfiguration,
                          "--preview: the pictures stay on the hosts of the cameras: camera_node "
                          "--preview there");
    auto work = own_work(config, *own);
    if (!work) return tl::unexpected(work.error());

    auto participant = bus::Participant::create(config.bus);
    if (!participant) return tl::unexpected(participant.error());
    const auto run_control = std::make_shared<RunControl>();
    auto member = presence::join_world(
        *participant,
        bus::ProgramKind::kRegionNode,
        bus::host_program_name(config.name, own->name),
        [run_control](const Error& lost) { run_control->lose_name(lost); },
        stop);
    if (!member) return tl::unexpected(member.error());
    auto orders = bus::Reader<bus::RegionOrder>::create(*participant,
                                                        hosts::order_part(config.name, own->name));
    if (!orders) return tl::unexpected(orders.error());
    auto meshes = bus::Writer<bus::RegionMeshes>::create(*participant, config.name);
    if (!meshes) return tl::unexpected(meshes.error());
    auto status = bus::Writer<bus::RegionNodeStatus>::create(*participant);
    if (!status) return tl::unexpected(status.error());
    auto waiter = bus::Waiter::create(*participant);
    if (!waiter) return tl::unexpected(waiter.error());
    waiter->add(*orders);
    app::log::info("regions host={} names=\"{}\" threads={}",
                   own->name,
                   fmt::join(own->regions, " "),
                   config.threads);
    return std::unique_ptr<RegionNode>(new RegionNode(
        std::move(config),
        own->name,
        std::move(*work),
        {std::move(*orders), std::move(*meshes), std::move(*status), std::move(*waiter)},
        run_control,
        std::move(*member)));
}

RegionNode::RegionNode(SiteNodeConfig config,
                       std::string host,
                       RegionWork work,
                       Bus bus,
                       std::shared_ptr<RunControl> run_control,
                       std::unique_ptr<presence::Membership> membership)
    : config_(std::move(config)),
      host_(std::move(host)),
      work_(std::move(work)),
      bus_(std::move(bus)),
      pool_(static_cast<std::size_t>(config_.threads)),
      run_control_(std::move(run_control)),
      membership_(std::move(membership)) {
    answer_.site = status_.site = config_.name;
    answer_.host = status_.host = host_;
    status_.num_regions = static_cast<std::uint32_t>(work_.num_regions());
}

Expected<void> RegionNode::run(std::stop_token stop) {
    if (auto begun = run_control_->begin(); !begun) return begun;
    const std::stop_callback pass_on(stop, [this] { run_control_->finish({}); });
    {
        const std::jthread worker =
            named_thread("work", [this](std::stop_token s) { follow_orders(std::move(s)); });
        report_status(run_control_->token());
    }
    const bus::RegionNodeStatus total = status();
    app::log::info("stopped orders={} meshes={} late={} failed={} {}",
                   total.num_orders,
                   total.num_meshes,
                   total.num_dropped_late,
                   total.num_failed,
                   atrium::status::process_fields(total.processor, total.first_output_s));
    return run_control_->result();
}

void RegionNode::follow_orders(std::stop_token stop) {
    constexpr std::chrono::milliseconds kPatience{500};
    const std::stop_callback wake(stop, [this] { bus_.waiter.wake(); });
    while (!stop.stop_requested()) {
        bus_.waiter.wait(kPatience);
        std::optional<bus::RegionOrder> newest;
        const auto report = bus_.orders.take([&](bus::RegionOrder&& order) {
            if (order.site == config_.name && order.host == host_) newest = std::move(order);
        });
        if (report.num_rejected > 0)
            complaints_.warn(fmt::format("orders_rejected num={} first=\"{}\"",
                                         report.num_rejected,
                                         report.first_rejection));
        if (newest) answer(*newest);
    }
}

void RegionNode::answer(const bus::RegionOrder& order) {
    const auto begin = Clock::now();
    {
        const std::lock_guard lock(mutex_);
        ++status_.num_orders;
        // a model part that was started anew begins at 1
        constexpr std::uint64_t kMostMissed = 1000;  // more is no number of this model part
        if (last_number_ > 0 && order.number > last_number_ &&
            order.number - last_number_ <= kMostMissed)
            status_.num_dropped_late += order.number - last_number_ - 1;
    }
    last_number_ = order.number;
    answer_.frame_id = order.frame_id;
    answer_.capture_time = order.capture_time;
    auto done = work_.compute(order, pool_, answer_);
    const auto publish_begin = Clock::now();
    std::size_t num_bytes = 0;
    if (done) {
        const auto written = bus_.meshes.write(answer_);
        if (written)
            num_bytes = *written;
        else
            done = tl::unexpected(written.error());
    }
    if (!done) {
        // nobody needs to wait for it
        work_.fail(done.error(), answer_);
        std::ignore = bus_.meshes.write(answer_);
    }
    const auto end = Clock::now();
    if (!done) complaints_.warn("not answered: " + done.error().message);
    if (done && !answer_.reason.empty()) complaints_.warn("region failed: " + answer_.reason);
    const std::lock_guard lock(mutex_);
    if (!done || !answer_.reason.empty()) ++status_.num_failed;
    if (!done) return;
    status_.num_meshes += static_cast<std::uint64_t>(
        std::ranges::count(answer_.regions, bus::RegionOutcome::kMesh, &bus::RegionHull::outcome));
    status_.num_bytes_published += num_bytes;
    if (status_.first_output_s == 0.0) status_.first_output_s = app::seconds_since_start();
    order_to_mesh_.add(end - begin);
    hull_.add(from_milliseconds(answer_.hull_ms));
    coding_.add(from_milliseconds(answer_.mesh_ms));
    publishing_.add(end - publish_begin);
}

void RegionNode::report_status(std::stop_token stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    RateMeter rate;
    RateMeter byte_rate;
    atrium::status::OverloadLog overload(bus::ProgramKind::kRegionNode);
    hosts::ModelPartWatch model_part(config_.hosts, Clock::now());
    const auto begin = Clock::now();
    const auto end = begin + std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(config_.seconds));
    while (!stop.stop_requested()) {
        auto until = next_second(begin, Clock::now());
        if (config_.seconds > 0.0) until = std::min(until, end);
        std::unique_lock lock(mutex);
        wake.wait_until(lock, stop, until, [] { return false; });
        if (config_.seconds > 0.0 && Clock::now() >= end) run_control_->finish({});
        {
            const std::lock_guard status_lock(mutex_);
            status_.orders_per_s = rate.update(status_.num_orders, Clock::now());
            status_.bytes_per_s = byte_rate.update(status_.num_bytes_published, Clock::now());
            status_.processor = processor_meter_.update();
        }
        const bus::RegionNodeStatus now = status();
        // orders come only with metaframes
        if (const auto event = model_part.look(bus_.orders.num_writers() > 0, Clock::now()))
            log(*event);
        if (const auto written = bus_.status.write(now); !written)
            complaints_.warn(written.error().message);
        if (const auto line = overload.look(atrium::status::figures_of(now), Clock::now()))
            app::log::warn("{}", *line);
    }
}

bus::RegionNodeStatus RegionNode::status() const {
    const std::lock_guard lock(mutex_);
    bus::RegionNodeStatus status = status_;
    status.time = Timestamp::now();
    status.resident_bytes = app::resident_bytes();
    status.order_to_mesh = summary(order_to_mesh_);
    status.stages = {
        0.0, summary(hull_).median_ms, summary(coding_).median_ms, summary(publishing_).median_ms};
    return status;
}

}  // namespace atrium::site_node
